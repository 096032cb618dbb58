#include "bind/keywords.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "bind/errors.h"
#include "bind/lists.h"
#include "innermap/core/memory.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

std::string typeName(py::handle value) {
  return py::cast<std::string>(py::type::of(value).attr("__name__"));
}

std::string words(const NumberRange& range) { return range.bounded() ? ", " + range.text() : ""; }

void requireInRange(const Setting& s, double value, const std::string& given) {
  if (value != s.automatic && !s.range.holds(value))
    throw SettingError(s.name, s.range.refusal(given, s.unit));
}

double numberFrom(const Setting& s, py::handle given, double) {
  if (PyBool_Check(given.ptr()) || !PyNumber_Check(given.ptr()))
    wrongType(s.name, "expects a number, got " + typeName(given));
  const double value = PyFloat_AsDouble(given.ptr());
  if (PyErr_Occurred()) throw py::error_already_set();
  requireInRange(s, value, fmt::format("{:g}", value));
  return value;
}

template <class Integer>
Integer numberFrom(const Setting& s, py::handle given, Integer) {
  if (PyBool_Check(given.ptr()) || !PyIndex_Check(given.ptr()))
    wrongType(s.name, "expects a whole number, got " + typeName(given));
  const py::object number = py::reinterpret_steal<py::object>(PyNumber_Index(given.ptr()));
  if (!number) throw py::error_already_set();
  int overflow = 0;
  const long long value = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
  const double rough =
      overflow ? overflow * std::numeric_limits<double>::infinity() : static_cast<double>(value);
  const double most = static_cast<double>(std::numeric_limits<Integer>::max());
  requireInRange(s, std::abs(rough) < most ? rough : rough * 1e300,
                 py::cast<std::string>(py::str(number)));
  return static_cast<Integer>(value);
}

bool isTrue(py::handle given) {
  const int truth = PyObject_IsTrue(given.ptr());
  if (truth < 0) throw py::error_already_set();
  return truth != 0;
}

// Lines of at most 90 letters, indented.
std::string wrapped(const std::string& text) {
  std::string out, line = "   ";
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    if (line.size() + 1 + end - at > 90) {
      out += line + "\n";
      line = "   ";
    }
    line += " " + text.substr(at, end - at);
    at = end + 1;
  }
  return out + line + "\n";
}

// The name that one who wrote `word` may have meant.
std::string nearest(const std::string& word, const std::vector<std::string>& names) {
  const py::list found = py::module_::import("difflib").attr("get_close_matches")(word, names, 1);
  return found.empty() ? std::string() : py::cast<std::string>(found[0]);
}

}  // namespace

py::object Keywords::take(const std::string& name) {
  names_.push_back(name);
  if (!sets_ || !given_.contains(name.c_str())) return py::none();
  return given_[name.c_str()];
}

py::object Keywords::take(const Setting& s) {
  if (s.formerName.empty() || !sets_ || !given_.contains(s.formerName.c_str())) return take(s.name);
  const std::string text = fmt::format("'{}' is now called '{}'", s.formerName, s.name);
  if (PyErr_WarnEx(PyExc_DeprecationWarning, text.c_str(), 1) != 0) throw py::error_already_set();
  names_.push_back(s.name);
  return take(s.formerName);
}

void Keywords::entry(const std::string& name, const std::string& type, const std::string& literal,
                     const std::string& range, const std::string& doc) {
  if (sets_) return;
  if (!signature_.empty()) signature_ += ", ";
  signature_ += fmt::format("{}={}", name, literal);
  docs_ += fmt::format("{} : {}{}{}\n", name, type, range,
                       literal == "None" ? "" : ", default " + literal);
  docs_ += wrapped(doc);
}

template <class Number>
void Keywords::takeNumber(const Setting& s, const std::string& doc, const Number* now,
                          const std::function<void(Number)>& set) {
  const bool chosen = !now || static_cast<double>(*now) == s.automatic;
  const py::object given = take(s);
  entry(s.name, std::is_integral_v<Number> ? "int" : "float",
        chosen ? "None" : fmt::format(std::is_integral_v<Number> ? "{}" : "{:g}", *now),
        words(s.range), doc);
  if (!given.is_none()) set(numberFrom(s, given, Number{}));
}

void Keywords::takeChoice(const Setting& s, const std::string& doc, const SettingChoice& choice) {
  const py::object given = take(s);
  const std::string all = fmt::format("'{}'", fmt::join(choice.words, "', '"));
  entry(s.name, all, s.fallback.empty() ? "'" + choice.words[choice.now()] + "'" : "None", "", doc);
  if (given.is_none()) return;
  if (!py::isinstance<py::str>(given)) wrongType(s.name, "expects one of " + all);
  const std::string text = textFrom(given, s.name);
  const auto found = std::find(choice.words.begin(), choice.words.end(), text);
  if (found == choice.words.end())
    throw SettingError(s.name, fmt::format("must be one of {}, got '{}'", all, text));
  choice.take(static_cast<std::size_t>(found - choice.words.begin()));
}

void Keywords::setting(const Setting& s) {
  const auto shown = [](const std::string& name) { return "`" + name + "`"; };
  std::string doc = withNames(s.help, shown);
  if (!s.unit.empty()) doc += " (" + s.unit + ")";
  if (!s.fallback.empty()) doc += "; " + withNames(s.fallback, shown) + " if not given";
  std::visit(
      [&](const auto& value) {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, SettingChoice>) {
          takeChoice(s, doc, value);
        } else if constexpr (std::is_same_v<Value, bool*>) {
          flag(s.name.c_str(), value, ((*value ? "False: " : "") + doc).c_str());
        } else if constexpr (std::is_arithmetic_v<std::remove_pointer_t<Value>>) {
          using Number = std::remove_pointer_t<Value>;
          takeNumber<Number>(s, doc, value, [&](Number number) { *value = number; });
        } else {
          using Number = typename std::remove_pointer_t<Value>::value_type;
          takeNumber<Number>(s, doc, *value ? &**value : nullptr,
                             [&](Number number) { *value = number; });
        }
      },
      s.value);
}

void Keywords::flag(const char* name, bool* value, const char* doc) {
  const py::object given = take(name);
  entry(name, "bool", *value ? "True" : "False", "", doc);
  if (!given.is_none()) *value = isTrue(given);
}

void Keywords::flag(const char* name, std::optional<bool>* value, const char* doc) {
  const py::object given = take(name);
  entry(name, "bool", *value ? (**value ? "True" : "False") : "None", "", doc);
  if (!given.is_none()) *value = isTrue(given);
}

void Keywords::text(const char* name, std::string* value, const char* doc) {
  const py::object given = take(name);
  entry(name, "str", "'" + *value + "'", "", doc);
  if (given.is_none()) return;
  *value = textFrom(given, name);
}

void Keywords::bytes(const char* name, std::uint64_t* value, const char* doc) {
  const py::object given = take(name);
  entry(name, "int or str", "None", "", doc);
  if (given.is_none())
    *value = availableMemory() / 10 * 8;
  else if (py::isinstance<py::str>(given))
    *value = parseBytes(name, textFrom(given, name));
  else
    *value = numberFrom(Setting(name, "N", value, doc).from(1, 9e18), given, std::uint64_t{});
  if (*value == 0) throw SettingError(name, "must be above 0; write for example '4GB'");
}

void Keywords::object(const char* name, py::object* value, const char* type, const char* doc) {
  const py::object given = take(name);
  entry(name, type, "None", "", doc);
  if (sets_) *value = given;
}

void Keywords::finish() const {
  for (const auto& item : given_) {
    const std::string name = textFrom(item.first, function_);
    if (std::find(names_.begin(), names_.end(), name) != names_.end()) continue;
    const std::string meant = nearest(name, names_);
    throw py::type_error(fmt::format("{}() has no argument '{}'{}", function_, name,
                                     meant.empty() ? "" : fmt::format("; is it '{}'?", meant)));
  }
}

std::string Keywords::signature() const { return signature_; }
std::string Keywords::docs() const { return docs_; }

namespace {

struct Parameter {
  std::string name;
  bool optional = false;
};

// "self, V, F=None": without self.
struct Parameters {
  std::vector<Parameter> all;
  bool method = false, any = false;

  explicit Parameters(const std::string& text) {
    std::size_t at = 0;
    while (at < text.size()) {
      const std::size_t end = std::min(text.find(", ", at), text.size());
      std::string name = text.substr(at, end - at);
      at = end + 2;
      if (name == "self") {
        method = true;
        continue;
      }
      if (name[0] == '*') any = true;
      const std::size_t equals = name.find('=');
      all.push_back({name.substr(0, equals), equals != std::string::npos});
    }
  }

  // Moves what is positional out of `keywords`.
  Arguments resolve(const std::string& function, const py::args& given, py::dict& keywords) const {
    Arguments out;
    for (const auto& value : given) out.push_back(py::reinterpret_borrow<py::object>(value));
    if (any) return out;
    const std::size_t first = method ? 1 : 0, most = first + all.size();
    if (out.size() > most)
      throw py::type_error(fmt::format("{}() takes {} argument{} without a name, got {}", function,
                                       all.size(), all.size() == 1 ? "" : "s", out.size() - first));
    for (std::size_t i = out.size() - first; i < all.size(); ++i) {
      const auto& [name, optional] = all[i];
      if (keywords.contains(name)) {
        out.push_back(keywords[name.c_str()]);
        keywords.attr("pop")(name);
      } else if (optional) {
        out.push_back(py::none());
      } else {
        throw py::type_error(fmt::format("{}() lacks its argument '{}'", function, name));
      }
    }
    return out;
  }
};

}  // namespace

void defineFunction(py::handle scope, const Function& function, const Keywords& described,
                    GeneralBody body) {
  const Parameters parameters(function.positional);
  std::string signature = function.positional;
  if (!described.signature().empty())
    signature += (signature.empty() ? "" : ", ") + std::string(parameters.any ? "" : "*, ") +
                 described.signature();
  std::string doc = fmt::format("{}({})\n--\n\n{}", function.name, signature, function.doc);
  if (!described.docs().empty()) doc += "\n\nKeyword arguments\n\n" + described.docs();
  const auto general = [parameters, scope, body = std::move(body),
                        name = std::string(function.name)](const py::args& given,
                                                           const py::kwargs& named) {
    if (parameters.method && (given.empty() || !py::isinstance(given[0], scope)))
      throw py::type_error(fmt::format("{}() is a method of {}", name,
                                       py::cast<std::string>(scope.attr("__name__"))));
    py::dict keywords(named);
    const Arguments arguments = parameters.resolve(name, given, keywords);
    return body(arguments, keywords);
  };
  if (parameters.method) {
    const py::cpp_function made(general, py::name(function.name), py::is_method(scope),
                                doc.c_str());
    py::setattr(scope, function.name, made);
  } else {
    const py::cpp_function made(general, py::name(function.name), py::scope(scope), doc.c_str());
    py::setattr(scope, function.name, made);
  }
}

std::string documented(const char* signature, const char* doc) {
  return fmt::format("{}\n--\n\n{}", signature, doc);
}

}  // namespace innermap::python
