#pragma once
/// Friction laws, noises and drag laws. Each is a file that declares its word, its options and how
/// it is made; all else that speaks of them follows from these declarations.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stickslip/base/text.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::effects {

// What is known of an option of the command line: the form and the range of its value, its
// default, what it does, and how pictures show it.

/// What a value must look like.
enum class Kind {
  real,     ///< a finite decimal number
  integer,  ///< a whole number
  choice,   ///< one of a few words
  list,     ///< a comma list of words, each at most once
  numbers,  ///< a,b,c or first:last:count or first:last:count:log
  text,     ///< free text
  flag,     ///< yes or no; yes if it stands alone
  path,     ///< a file to write
  input,    ///< a file to read
};

/// An interval of numbers; unbounded and open by default.
struct Range {
  double low = -kInfinity;
  double high = kInfinity;
  bool low_included = false;
  bool high_included = false;

  [[nodiscard]] bool contains(double value) const;
  /// "(0, inf)".
  [[nodiscard]] std::string text() const;

  static Range positive() { return {0, kInfinity, false, false}; }
  static Range not_negative() { return {0, kInfinity, true, false}; }
  static Range whole(double low, double high) { return {low, high, true, true}; }
};

/// Ends of a slider over a number, and where it stands at first. Without a start the option is left
/// out until the slider is moved.
struct Slider {
  double low;
  double high;
  std::optional<double> start = {};
  bool logarithmic = false;
};

/// How an option is shown, and what else it is called.
struct Shown {
  std::string symbol = {};               ///< TeX, such as "c_3"
  std::string label = {};                ///< before the symbol on an axis
  std::optional<Slider> slider = {};     ///< over what is worth to be explored
  std::vector<std::string> others = {};  ///< names of the literature and of other programs
  std::string page = {};                 ///< of the manual where to read more
};

/// What to do about a number that the program chooses unless it is given.
inline constexpr const char* kChosen = "leave it out to have it chosen from -accuracy";

struct Option {
  std::string name;                ///< without the dash
  Kind kind;                       ///< form of the value
  std::string form;                ///< of the value, by the name that cli::forms() explains
  std::string unit;                ///< of a number; empty if it has none
  std::string initial;             ///< default as text; empty: see `sentence`
  Range range;                     ///< of a number
  std::vector<std::string> words;  ///< allowed words; beside numbers for kind integer
  std::string sentence;            ///< what it does
  std::string fix;                 ///< what to do about a value out of range; may be empty
  Shown shown = {};
  bool adds = false;  ///< whether words may be joined by +

  /// The same with other names.
  [[nodiscard]] Option called(const std::vector<std::string>& others) const {
    Option option = *this;
    option.shown.others = others;
    return option;
  }
  static Option real(const char* name, const char* unit, const char* initial, Range range,
                     const std::string& sentence, const std::string& fix = kChosen,
                     const Shown& shown = {}) {
    return {name, Kind::real, "number", unit, initial, range, {}, sentence, fix, shown};
  }
  static Option integer(const char* name, const char* initial, Range range, const char* sentence,
                        const char* fix = kChosen, const std::vector<std::string>& words = {},
                        const Shown& shown = {}) {
    return {name, Kind::integer, "integer", "", initial, range, words, sentence, fix, shown};
  }
  static Option text_of(const char* name, const char* form, const char* initial,
                        const std::string& sentence) {
    return {name, Kind::text, form, "", initial, {}, {}, sentence, ""};
  }
  static Option file(const std::string& name, Kind kind, const std::string& sentence,
                     const Shown& shown = {}) {
    return {name, kind, "file", "", "", {}, {}, sentence, "", shown};
  }
};

/// The values of options, and where to complain about them.
class Given {
 public:
  virtual ~Given() = default;

  /// Whether the user gave the option.
  [[nodiscard]] virtual bool has(const std::string& option) const = 0;
  /// The value as given, or its default. A number without default may be asked for only where it
  /// was given.
  [[nodiscard]] virtual double real(const std::string& option) const = 0;
  [[nodiscard]] virtual std::string text(const std::string& option) const = 0;
  /// Nothing if neither exists or a word was given.
  [[nodiscard]] virtual std::optional<int> integer(const std::string& option) const = 0;
  /// Reports what is wrong with the value of an option, and what to do about it.
  virtual void refuse(const std::string& option, const std::string& why,
                      const std::string& fix) = 0;
  /// Whether nothing has been refused so far.
  [[nodiscard]] virtual bool sound() const = 0;

 protected:
  Given() = default;
  Given(const Given&) = default;
  Given& operator=(const Given&) = default;
};

/// An option of an effect, what happens where no effect in use knows it, and where the effect
/// cannot do without it, a value for it.
struct Parameter {
  Option option;
  bool refused_elsewhere = false;  ///< otherwise a warning says that it has no effect
  std::string example = {};
};

/// One of the words of a choice, such as -drag cubic.
struct Effect {
  std::string_view word;
  /// What it is, for the help of its choice; of a drag law b(v), with the symbols of its options.
  std::string_view sentence;
  std::vector<std::string> others = {};     ///< words that mean it elsewhere
  std::vector<std::string> explained = {};  ///< words that mean what `page` says how to get by it
  std::string page = {};
  std::vector<Parameter> parameters = {};
  /// Puts the values of its options, with all that it cannot do without, into a scene that holds
  /// friction coefficients and bias. Without this function they go into Scene::own.
  void (*read)(Given&, model::Scene&) = nullptr;
  /// Makes what depends on other options, once the scene holds all numbers. Returns whether the
  /// scene is as the effect needs it; where not, that is reported.
  bool (*complete)(Given&, model::Scene&) = nullptr;
  /// Of a noise that is a table of levels: makes it of the values that `read` has put into the
  /// scene. Throws std::invalid_argument.
  model::LevelTable (*levels)(const model::Scene&) = nullptr;
  /// The values that files state before those of Scene::own that the effect knows.
  model::Parameters (*values)(const model::Scene&) = nullptr;
  /// The same for the headings of tables. Without this function they say "name = value" of each.
  std::string (*heading)(const model::Scene&) = nullptr;
  /// The parameters by which results can be differentiated where the effect is in use. They need
  /// not be its own: friction that weakens lets mu_s act on sliding bodies.
  std::vector<model::Derivative> derivatives = {};
  /// Of a noise: how to make it stronger, where it never moves a body.
  std::string (*stronger)(const model::Scene&) = nullptr;

  [[nodiscard]] bool knows(std::string_view option) const;
};

/// An option whose words are effects, the default first.
struct Choice {
  std::string_view option;
  std::string_view title;  ///< what is chosen, for its help
  std::span<const Effect* const> effects;
  const std::string& (*word_in)(const model::Scene&);
  const Effect* sum = nullptr;  ///< what words joined by + mean, where they may be

  /// The effect of that word; the default where there is none. That of an empty word does nothing.
  [[nodiscard]] const Effect& of(std::string_view word) const;
  /// The words of which a word is the sum, or that word alone.
  [[nodiscard]] std::vector<std::string> parts(const std::string& word) const;
  /// Whether the effect of the scene, or one of those of which it is the sum, knows the option.
  [[nodiscard]] bool knows(const model::Scene& scene, std::string_view name) const;
  [[nodiscard]] const Effect& in(const model::Scene& scene) const { return of(word_in(scene)); }
  /// The effect of the scene, or those of which it is the sum.
  [[nodiscard]] std::vector<const Effect*> all_in(const model::Scene& scene) const;
};

/// -friction, -noise and -drag.
[[nodiscard]] const Choice& frictions();
[[nodiscard]] const Choice& noises();
[[nodiscard]] const Choice& drags();
[[nodiscard]] std::span<const Choice* const> choices();

/// Whether an option is of a choice, or of its effects, and none in use knows it.
[[nodiscard]] bool is_idle(const model::Scene& scene, std::string_view option);

/// Puts the values of the options of an effect into a scene; what is missing is refused.
void read_effect(Given& given, const Choice& choice, const std::string& word, model::Scene& scene);

/// The value of that name in Scene::own, which has one.
[[nodiscard]] const std::variant<double, std::string>& own_value(const model::Scene& scene,
                                                                 std::string_view name);
/// The same for one that is a number.
[[nodiscard]] double own_number(const model::Scene& scene, std::string_view name);

/// Makes the levels of a noise that is a table of the values in the scene. Throws
/// std::invalid_argument.
void make_noise_levels(model::Scene& scene);

/// Makes the drag of a scene from a formula in v, mu_s, mu_d and tau, after examining it at the
/// speeds that the noise brings about. Returns whether it can be a drag; where not, that is
/// reported of `option`.
bool set_drag(Given& given, model::Scene& scene, const char* option, const std::string& formula);

/// The same again of the formula in the scene, for its forces and its tau. Throws BadInput.
void renew_drag(model::Scene& scene);

/// All that fixes the process of a scene, each by the name of its option, in the order in which
/// files hold them: friction, the word of the drag law, noise, what is beside the defaults, and the
/// coefficients of the drag. Left out are the range of the noise, the levels of a table, and a
/// truncation velocity that is no part of the model.
[[nodiscard]] model::Parameters parameters_of(const model::Scene& scene);

/// The parameters by which results of a scene can be differentiated: mu_d, mu_d_minus where it is
/// given, and those that its effects declare.
[[nodiscard]] std::vector<model::Derivative> derivatives_of(const model::Scene& scene);

/// How nodes of an order change with one of these parameters, by differences between values next to
/// it, with elements that move along; null where they do not change, as with the drag, and of noise
/// without them.
[[nodiscard]] std::shared_ptr<const model::NodeChange>
change_of_nodes(const model::Scene& scene, const model::Derivative& by, int order);

/// What the headings of tables say of an effect of a scene, such as "tau = 1" and "delta = 0.125".
[[nodiscard]] std::vector<std::string> heading(const Effect& effect, const model::Scene& scene);

// The options of the model.

/// Those of every scene, and those that the effects declare, in the order of the help text.
[[nodiscard]] const std::vector<Option>& model_options();

/// The one of that name, which exists.
[[nodiscard]] const Option& model_option(std::string_view name);

// From the values of the model's options to a scene.

/// What drives bodies, as far as anything is asked of it.
enum class Drive { noise, given_force, both };

/// The parameters of the model; v_max and the noise levels may stay open. What is wrong with them,
/// each by itself or together, is refused. What does not drive is not read.
[[nodiscard]] model::Scene read_scene(Given& given, Drive drive = Drive::noise);

/// What to say of a given force under which friction holds the body all the time; empty where it
/// moves, and without such a force.
[[nodiscard]] std::string force_note(const model::Scene& scene);

/// What to say where static friction acts with another value than the one given, because it lies
/// between two noise levels; empty where it does not.
[[nodiscard]] std::string step_warning(const model::Scene& scene);

// Noise levels from a file.

/// The levels in a CSV file with the columns x,rate_up,rate_down. Throws std::invalid_argument with
/// the line and the value that is wrong.
[[nodiscard]] model::LevelTable read_levels(const std::string& file);

}  // namespace stickslip::effects
