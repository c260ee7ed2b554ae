#include <fmt/format.h>

#include <filesystem>

#include "stickslip/io/hdf5_file.hpp"
#include "stickslip/io/provenance.hpp"
#include "stickslip/io/report.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/quantities/density.hpp"

namespace stickslip::io {
namespace {

void write_results(Hdf5File& file, const quantities::Results& results) {
  file.make_group("/results");
  for (const auto& r : results) {
    const std::string group = "/results/" + r.key;
    file.make_group(group);
    if (!r.unit.empty()) file.attribute(group, "unit", r.unit);
    if (r.is_scalar()) {
      file.write_scalar(group + "/value", r.value[0]);
      file.write_scalar(group + "/error", r.error[0]);
    } else {
      file.write_array(group + "/" + r.abscissa_name, r.abscissa);
      file.write_array(group + "/value", r.value);
      file.write_array(group + "/error", r.error);
    }
  }
}

void write_record(Hdf5File& file, MPI_Comm comm, const options::Request& request,
                  const accuracy::Outcome& outcome, const RunTimes& times) {
  file.make_group("/record");
  for (const auto& [name, value] : provenance(comm)) file.attribute("/record", name, value);
  file.make_group("/record/options");
  for (const auto& [name, value] : request.resolved) {
    file.attribute("/record/options", name, value);
  }
  file.attribute("/record", "accuracy_reached", outcome.reached ? "yes" : "no");
  file.attribute("/record", "seconds", times.total);
}

void write_density(Hdf5File& file, const quantities::DensityField& field, double error) {
  file.make_group("/density");
  file.write_array("/density/x", field.x);
  file.write_array("/density/v", field.v);
  const int n = static_cast<int>(field.x.size()) / 2;
  std::vector<std::size_t> rows;
  for (int i : field.local_levels) rows.push_back(static_cast<std::size_t>(i + n));
  file.write_rows("/density/pdf", field.x.size(), field.v.size(), rows, field.local_rows);
  file.write_array("/density/atom", field.atom);
  file.write_array("/density/marginal_x", field.noise_marginal);
  file.write_array("/density/marginal_v", field.velocity_marginal);
  file.attribute("/density/pdf", "meaning",
                 "P(X = x_i, V in dv)/dv by rows of x and columns of v, without the atom at v = 0");
  file.attribute("/density/atom", "meaning", "P(X = x_i, V = 0 and sticking)");
  file.attribute("/density/marginal_x", "meaning", "P(X = x_i), summed over the grid");
  file.attribute("/density/marginal_v", "meaning", "density of V without its atom P_stick at 0");
  file.attribute("/density", "error_of_distribution_function_of_speed", error);
  file.attribute("/density", "probability_at_velocity_cut", field.cut_mass);
}

// A rectilinear grid for ParaView and VisIt: v across, x upwards.
std::string xdmf(const std::string& hdf5_name, const quantities::DensityField& field) {
  const auto item = [&](std::size_t rows, std::size_t columns, const char* name) {
    const std::string size =
        columns == 0 ? std::to_string(rows) : fmt::format("{} {}", rows, columns);
    return fmt::format("<DataItem Dimensions=\"{}\" NumberType=\"Float\" Precision=\"8\" "
                       "Format=\"HDF\">{}:/density/{}</DataItem>",
                       size, hdf5_name, name);
  };
  const std::size_t rows = field.x.size(), columns = field.v.size();
  return fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<Xdmf Version=\"3.0\"><Domain><Grid Name=\"density\" GridType=\"Uniform\">\n"
      "<Topology TopologyType=\"2DRectMesh\" Dimensions=\"{} {}\"/>\n"
      "<Geometry GeometryType=\"VXVY\">\n{}\n{}\n</Geometry>\n"
      "<Attribute Name=\"pdf\" AttributeType=\"Scalar\" Center=\"Node\">\n{}\n</Attribute>\n"
      "</Grid></Domain></Xdmf>\n",
      rows, columns, item(columns, 0, "v"), item(rows, 0, "x"), item(rows, columns, "pdf"));
}

}  // namespace

void write_hdf5(MPI_Comm comm, const options::Request& request, const accuracy::Outcome& outcome,
                const RunTimes& times) {
  Hdf5File file(comm, request.output);
  write_results(file, outcome.results);
  write_record(file, comm, request, outcome, times);
  if (!request.wants(options::Quantity::density)) return file.commit();
  const auto field = quantities::density_field(*outcome.law);
  write_density(file, field, outcome.speed_law_error);
  file.commit();
  if (petsc::rank(comm) != 0) return;
  const std::filesystem::path name = request.output;
  std::filesystem::path beside = name;
  beside.replace_extension(".xdmf");
  write_text(beside.string(), xdmf(name.filename().string(), field));
}

}  // namespace stickslip::io
