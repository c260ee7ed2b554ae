#include "stickslip/cli/hdf5_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <numeric>
#include <utility>

#include "stickslip/base/errors.hpp"
#include "stickslip/cli/output.hpp"
#include "stickslip/linalg/session.hpp"

namespace stickslip::cli {
namespace {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

long shared_tag(MPI_Comm comm) {
  long tag = getpid();
  MPI_Bcast(&tag, 1, MPI_LONG, 0, comm);
  return tag;
}

// Throws when HDF5 refused to give an identifier.
Hdf5Id given(hid_t id, herr_t (*close)(hid_t), const std::string& what) {
  if (id < 0) throw SystemFailure("HDF5 refused " + what);
  return {id, close};
}

void require(herr_t status, const std::string& what) {
  if (status < 0) throw SystemFailure("HDF5 could not write " + what);
}

Hdf5Id space_of(std::span<const hsize_t> sizes, const std::string& what) {
  return given(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose,
               what);
}

Hdf5Id dataset(hid_t file, const std::string& path, hid_t space) {
  return given(H5Dcreate2(file, path.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT,
                          H5P_DEFAULT),
               H5Dclose, path);
}

// Adds rows [first, first + count) of a matrix with `columns` columns to the selection of a space.
void select_rows(hid_t space, H5S_seloper_t how, hsize_t first, hsize_t count, hsize_t columns) {
  const std::array<hsize_t, 2> start{first, 0}, size{count, columns};
  require(H5Sselect_hyperslab(space, how, start.data(), nullptr, size.data(), nullptr), "rows");
}

void write_attribute(hid_t file, const std::string& path, const std::string& name, hid_t type,
                     const void* value) {
  const Hdf5Id object = given(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose, path);
  const Hdf5Id space = given(H5Screate(H5S_SCALAR), H5Sclose, name);
  const Hdf5Id attribute = given(
      H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
  require(H5Awrite(attribute, type, value), name);
}

/// A field over the axes x and v of a group.
void write_field(Hdf5File& file, const std::string& group, const std::string& name,
                 const quantities::PhaseField& field) {
  const std::string path = group + "/" + name;
  file.write_rows(path, field.x().size(), field.v().size(), field.local_levels(),
                  field.local_rows());
  file.set_axes(path, {group + "/x", group + "/v"});
}

void write_over(Hdf5File& file, const std::string& path, const std::string& axis,
                std::span<const double> values) {
  file.write_array(path, values);
  file.set_axes(path, {axis});
}

void write_axes(Hdf5File& file, const std::string& group, const quantities::PhaseField& field) {
  file.make_group(group);
  write_over(file, group + "/x", group + "/x", field.x());
  write_over(file, group + "/v", group + "/v", field.v());
}

void write_density(Hdf5File& file, const quantities::DensityField& field, double error) {
  const auto write = [&file](const std::string& name, const auto& values, const std::string& axis,
                             const char* meaning) {
    const std::string path = "/density/" + name;
    write_over(file, path, "/density/" + axis, values);
    file.attribute(path, "meaning", meaning);
  };
  write_axes(file, "/density", field.pdf);
  write("weights", field.weights, "v", "sum_j weights_j f(v_j) = integral of f");
  write("cells", field.cells, "cells",
        "between two of them the density is the polynomial through the nodes there");
  write("atom", field.atom, "x", "P(X = x_i, V = 0 and sticking)");
  write("marginal_x", field.noise_marginal, "x",
        "P(X = x_i), summed over the grid; of noise without levels, of the steps around x_i");
  write("marginal_v", field.velocity_marginal, "v", "density of V without its atom P_stick at 0");
  if (!field.states.empty()) {
    write("state", field.states, "x", "number of the state of each row, as the noise numbers them");
  }
  write_field(file, "/density", "pdf", field.pdf);
  file.attribute("/density/pdf", "meaning",
                 "P(X = x_i, V in dv)/dv by rows of x and columns of v, without the atom at v = 0");
  file.attribute("/density/pdf", "smallest_value", field.least);
  if (const auto& [p, pdf, atom, marginal] = field.position; !p.empty()) {
    file.make_group("/density/position");
    write("position/p", p, "position/p", "positions of the spring, evenly spaced");
    write("position/atom", atom, "position/p", "P(P in the step around p_i, V = 0 and sticking)");
    write("position/marginal_p", marginal, "position/p", "P(P in the step around p_i)");
    std::vector<std::size_t> rows(pdf.size() / field.pdf.v().size());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    file.write_rows("/density/position/pdf", p.size(), field.pdf.v().size(), rows, pdf);
    file.set_axes("/density/position/pdf", {"/density/position/p", "/density/v"});
    file.attribute("/density/position/pdf", "meaning",
                   "P(P in the step around p_i, V in dv)/dv by rows of p and columns of v");
  }
  file.attribute("/density", "error_of_distribution_function_of_speed", error);
  file.attribute("/density", "probability_at_velocity_cut", field.truncated_mass);
}

void write_path(Hdf5File& file, const simulation::Path& path) {
  file.make_group("/trajectory");
  file.attribute("/trajectory", "meaning",
                 "state just after each event; between events x and y stay and v follows the flow");
  const std::string time = "/trajectory/time";
  write_over(file, time, time, path.time);
  write_over(file, "/trajectory/x", time, path.x);
  write_over(file, "/trajectory/y", time, path.y);
  write_over(file, "/trajectory/v", time, path.v);
}

void write_modes(Hdf5File& file, const quantities::RelaxationSector& sector) {
  const auto& modes = sector.modes;
  if (modes.empty()) return;
  const std::string group =
      fmt::format("/{}", quantities::relaxation_rows(sector.symmetry).rate.key);
  write_axes(file, group, modes[0].real);
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const std::string name = fmt::format("{}/mode_{}", group, n + 1);
    std::vector<double> real, imaginary;
    for (const auto& value : modes[n].at_rest) {
      real.push_back(value.real());
      imaginary.push_back(value.imag());
    }
    file.make_group(name);
    file.attribute(name, "rate", modes[n].rate.real());
    file.attribute(name, "frequency", modes[n].rate.imag());
    write_field(file, group, fmt::format("mode_{}/real", n + 1), modes[n].real);
    write_field(file, group, fmt::format("mode_{}/imaginary", n + 1), modes[n].imaginary);
    file.write_array(name + "/at_rest_real", real);
    file.write_array(name + "/at_rest_imaginary", imaginary);
  }
}

// A rectilinear grid for ParaView and VisIt: v across, x upwards.
std::string xdmf(const std::string& file_name, const quantities::DensityField& field) {
  const auto item = [&](std::size_t rows, std::size_t columns, const char* name) {
    const std::string size =
        columns == 0 ? std::to_string(rows) : fmt::format("{} {}", rows, columns);
    return fmt::format("<DataItem Dimensions=\"{}\" NumberType=\"Float\" Precision=\"8\" "
                       "Format=\"HDF\">{}:/density/{}</DataItem>",
                       size, file_name, name);
  };
  const std::size_t rows = field.pdf.x().size(), columns = field.pdf.v().size();
  return fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<Xdmf Version=\"3.0\"><Domain><Grid Name=\"density\" GridType=\"Uniform\">\n"
      "<Topology TopologyType=\"2DRectMesh\" Dimensions=\"{} {}\"/>\n"
      "<Geometry GeometryType=\"VXVY\">\n{}\n{}\n</Geometry>\n"
      "<Attribute Name=\"pdf\" AttributeType=\"Scalar\" Center=\"Node\">\n{}\n</Attribute>\n"
      "</Grid></Domain></Xdmf>\n",
      rows, columns, item(columns, 0, "v"), item(rows, 0, "x"), item(rows, columns, "pdf"));
}

// A slash in a key would make a group of its own.
std::string hdf5_name(std::string key) {
  std::replace(key.begin(), key.end(), '/', ':');
  return key;
}

/// Writes a tree to a group of its own: objects as groups, texts and truths (yes, no) as attributes
/// of their group, numbers and arrays of numbers as datasets, ci95 as two of them, low and high.
/// Values are over the array that precedes them, if there is one. Collective with equal trees.
void write_tree(Hdf5File& file, const std::string& group, const Json& tree) {
  // A pair for each value, or the only pair.
  const auto end_of = [](const Json& ci95, std::size_t end) {
    if (ci95.at(0).is_number()) return ci95[end];
    Json ends;
    for (const auto& pair : ci95) ends.push_back(pair[end]);
    return ends;
  };
  const bool has_axis = tree.contains("value") && tree.begin().key() != "value" &&
                        tree.begin()->is_array() && tree["value"].is_array();
  const std::string axis = has_axis ? group + "/" + hdf5_name(tree.begin().key()) : "";
  const auto write = [&](const std::string& name, const Json& value) {
    const std::string path = group + "/" + hdf5_name(name);
    if (!value.is_array()) return file.write_scalar(path, value.get<double>());
    write_over(file, path, axis, value.get<std::vector<double>>());
  };
  file.make_group(group);
  for (const auto& [name, value] : tree.items()) {
    if (value.is_object()) {
      write_tree(file, group + "/" + hdf5_name(name), value);
    } else if (value.is_string()) {
      file.attribute(group, name, value.get<std::string>());
    } else if (value.is_boolean()) {
      file.attribute(group, name, value.get<bool>() ? "yes" : "no");
    } else if (name == "ci95") {
      write("low", end_of(value, 0));
      write("high", end_of(value, 1));
    } else {
      write(name, value);
    }
  }
}

// One group for each quantity, with a row for each of its arguments.
void write_comparison(Hdf5File& file, const Json& comparison) {
  Json tree{{"file", comparison["file"]}, {"disagrees", comparison["disagrees"]}};
  for (const auto& row : comparison["rows"]) {
    Json& group = tree[row["quantity"].get<std::string>()];
    group["argument"].push_back(row.value("argument", 0.0));
    for (const char* name : {"value", "error", "reference", "ci95", "z"}) {
      group[name].push_back(row[name]);
    }
  }
  write_tree(file, "/comparison", tree);
}

void write_study(Hdf5File& file, const Json& study) {
  Json tree{{"kind", study["kind"]}};
  const Json tables = study.value("tables", Json::object());
  for (const auto& [title, table] : tables.items()) {
    std::string name = title;
    std::replace(name.begin(), name.end(), ' ', '_');  // blanks are awkward to type
    tree[name] = table;
  }
  write_tree(file, "/study", tree);
}

// A group with texts of its own. Some readers cannot take empty attributes, so there are none.
void write_texts(Hdf5File& file, const std::string& group, const Texts& texts) {
  file.make_group(group);
  for (const auto& [name, text] : texts) {
    if (!text.empty()) file.attribute(group, name, text);
  }
}

void write_grid(Hdf5File& file, const Grid& grid) {
  write_texts(file, "/sweep", grid.notes);
  for (const auto& array : grid.arrays) {
    const std::string path = "/sweep/" + hdf5_name(array.name);
    file.write_array(path, array.sizes, array.values);
    std::vector<std::string> axes;
    for (const auto& axis : array.axes) {
      axes.push_back(axis.empty() ? "" : "/sweep/" + hdf5_name(axis));
    }
    file.set_axes(path, axes);
    for (const auto& [name, text] : array.notes) file.attribute(path, name, text);
  }
}

void write_results(Hdf5File& file, const Report& report) {
  const Json tree = report.tree();
  if (tree.contains("study")) return write_study(file, tree["study"]);
  write_tree(file, "/results", tree["results"]);
  if (tree.contains("comparison")) write_comparison(file, tree["comparison"]);
  file.attribute("/record", "accuracy_reached",
                 tree["accuracy"]["reached"].get<bool>() ? "yes" : "no");
  for (const auto& sector : report.modes) write_modes(file, sector);
  if (report.path != nullptr) write_path(file, *report.path);
  if (report.density != nullptr) write_density(file, *report.density, report.speed_error);
}

void write_whole(const Report& report, const std::string& target) {
  Hdf5File file(report.comm, target);
  std::vector<std::string> unused;
  for (const auto& [name, text] : report.options) {
    if (text.empty()) unused.push_back(name);
  }
  Texts record = report.provenance;
  record.emplace_back("warnings", fmt::format("{}", fmt::join(report.warnings, "\n")));
  record.emplace_back("options_without_effect", fmt::format("{}", fmt::join(unused, ",")));
  write_texts(file, "/record", record);
  write_texts(file, "/record/options", report.options);
  file.attribute("/record", "seconds", report.seconds);
  report.grid ? write_grid(file, report.grid()) : write_results(file, report);
  file.commit();
}

// HDF5 does not hand on what the system says.
void write_hdf5(const Report& report, const std::string& target) {
  try {
    write_whole(report, target);
  } catch (const SystemFailure& failure) {
    std::error_code unknown;
    const auto folder = std::filesystem::absolute(target, unknown).parent_path();
    constexpr std::uintmax_t least = 1 << 20;
    const bool full = std::filesystem::space(folder, unknown).available < least;
    throw SystemFailure(fmt::format("cannot write {}: {}{}", target, failure.what(),
                                    full ? "; no space is left on the device" : ""));
  }
  if (report.density == nullptr || linalg::rank(report.comm) != 0) return;
  std::filesystem::path beside(target);
  const std::string text = xdmf(beside.filename().string(), *report.density);
  write_text(beside.replace_extension(".xdmf").string(), text);
}

}  // namespace

Hdf5File::Hdf5File(MPI_Comm comm, const std::string& target)
    : comm_(comm), file_(target, shared_tag(comm)) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // failures are reported by exceptions
  const Hdf5Id access = given(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "a list of properties");
  // MPI adds words of its own to those of a full disk; a single process does without it.
  if (linalg::ranks(comm) > 1) {
    require(H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL), file_.part());
  }
  id_ = H5Fcreate(file_.part().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (id_ < 0) throw SystemFailure("cannot create " + file_.part());
}

Hdf5File::~Hdf5File() {
  // Collective: where one rank unwinds alone, the others would be waited for.
  const bool alone = std::uncaught_exceptions() > 0 && linalg::ranks(comm_) > 1;
  if (id_ >= 0 && !alone) (void)H5Fclose(id_);
}

void Hdf5File::make_group(const std::string& path) {
  const Hdf5Id group =
      given(H5Gcreate2(id_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path);
}

void Hdf5File::write_array(const std::string& path, std::span<const double> values) {
  write_array(path, std::array{values.size()}, values);
}

void Hdf5File::write_array(const std::string& path, std::span<const std::size_t> sizes,
                           std::span<const double> values) {
  const std::vector<hsize_t> counts(sizes.begin(), sizes.end());
  const Hdf5Id space = space_of(counts, path);
  const Hdf5Id data = dataset(id_, path, space);
  if (linalg::rank(comm_) != 0) return;
  require(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path);
}

void Hdf5File::write_scalar(const std::string& path, double value) {
  write_array(path, std::span<const std::size_t>{}, {&value, 1});
}

void Hdf5File::write_rows(const std::string& path, std::size_t row_count, std::size_t columns,
                          std::span<const std::size_t> rows, std::span<const double> values) {
  const std::array<hsize_t, 2> size{row_count, columns};
  const Hdf5Id file_space = space_of(size, path);
  const Hdf5Id data = dataset(id_, path, file_space);
  // One row at a time: HDF5 writes a selection in the order of the file, not of `rows`.
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const std::array<hsize_t, 2> one{1, columns};
    const Hdf5Id memory_space = space_of(one, path);
    select_rows(file_space, H5S_SELECT_SET, rows[n], 1, columns);
    require(H5Dwrite(data, H5T_NATIVE_DOUBLE, memory_space, file_space, H5P_DEFAULT,
                     values.data() + n * columns),
            path);
  }
}

void Hdf5File::set_axes(const std::string& path, const std::vector<std::string>& axes) {
  const Hdf5Id data = given(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose, path);
  if (axes == std::vector{path}) {
    return require(H5DSset_scale(data, path.substr(path.rfind('/') + 1).c_str()), path);
  }
  for (unsigned n = 0; n < axes.size(); ++n) {
    if (axes[n].empty()) continue;
    const Hdf5Id scale = given(H5Dopen2(id_, axes[n].c_str(), H5P_DEFAULT), H5Dclose, axes[n]);
    require(H5DSattach_scale(data, scale, n), path);
  }
}

void Hdf5File::attribute(const std::string& path, const std::string& name,
                         const std::string& value) {
  const Hdf5Id type = given(H5Tcopy(H5T_C_S1), H5Tclose, name);
  require(H5Tset_size(type, H5T_VARIABLE), name);
  require(H5Tset_cset(type, H5T_CSET_UTF8), name);
  const char* text = value.c_str();
  write_attribute(id_, path, name, type, &text);
}

void Hdf5File::attribute(const std::string& path, const std::string& name, double value) {
  write_attribute(id_, path, name, H5T_NATIVE_DOUBLE, &value);
}

void Hdf5File::commit() {
  require(H5Fflush(id_, H5F_SCOPE_GLOBAL), file_.part());
  require(H5Fclose(std::exchange(id_, -1)), file_.part());
  if (linalg::rank(comm_) == 0) file_.commit();
  MPI_Barrier(comm_);
}

extern const Output kHdf5{
    .option = "output",
    .ending = "h5",
    .sentence = "write results and fields as HDF5 to this file; with density also FILE.xdmf, which "
                "ParaView opens",
    .synonyms = {"o", "out", "h5", "hdf5", "save"},
    .subjects = {Subject::run, Subject::study, Subject::sweep},
    .fields = {cases::Quantity::density, cases::Quantity::trajectory},
    .collective = true,
    .write = write_hdf5};

}  // namespace stickslip::cli
