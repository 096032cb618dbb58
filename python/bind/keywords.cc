#include "bind/keywords.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bind/errors.h"
#include "bind/lists.h"
#include "innermap/core/memory.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

std::string typeName(py::handle value) {
  return py::cast<std::string>(py::type::of(value).attr("__name__"));
}

std::string words(const Range& range) {
  const bool below = std::isfinite(range.least), above = std::isfinite(range.most);
  if (below && above) return fmt::format(", in [{:g}, {:g}]", range.least, range.most);
  if (below) return fmt::format(", at least {:g}", range.least);
  return above ? fmt::format(", at most {:g}", range.most) : "";
}

double numberFrom(const char* name, py::handle given, const Range& range) {
  if (PyBool_Check(given.ptr()) || !PyNumber_Check(given.ptr()))
    wrongType(name, "expects a number, got " + typeName(given));
  const double value = PyFloat_AsDouble(given.ptr());
  if (PyErr_Occurred()) throw py::error_already_set();
  if (!(value >= range.least && value <= range.most))
    throw SettingError(name, fmt::format("must be a number{}, got {:g}", words(range), value));
  return value;
}

std::int64_t wholeFrom(const char* name, py::handle given, const Range& range) {
  if (PyBool_Check(given.ptr()) || !PyIndex_Check(given.ptr()))
    wrongType(name, "expects a whole number, got " + typeName(given));
  const py::object number = py::reinterpret_steal<py::object>(PyNumber_Index(given.ptr()));
  if (!number) throw py::error_already_set();
  int overflow = 0;
  const long long value = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
  if (overflow != 0 || !(static_cast<double>(value) >= range.least) ||
      !(static_cast<double>(value) <= range.most))
    throw SettingError(name, fmt::format("must be a whole number{}, got {}", words(range),
                                         py::cast<std::string>(py::str(number))));
  return value;
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

py::object Keywords::take(const char* name) {
  names_.emplace_back(name);
  if (!sets_ || !given_.contains(name)) return py::none();
  return given_[name];
}

void Keywords::entry(const char* name, const std::string& type, const std::string& literal,
                     const std::string& range, const char* doc) {
  if (sets_) return;
  if (!signature_.empty()) signature_ += ", ";
  signature_ += fmt::format("{}={}", name, literal);
  docs_ += fmt::format("{} : {}{}{}\n", name, type, range,
                       literal == "None" ? "" : ", default " + literal);
  docs_ += wrapped(doc);
}

void Keywords::number(const char* name, double* value, Range range, const char* doc) {
  const py::object given = take(name);
  entry(name, "float", fmt::format("{:g}", *value), words(range), doc);
  if (!given.is_none()) *value = numberFrom(name, given, range);
}

void Keywords::number(const char* name, std::optional<double>* value, Range range,
                      const char* doc) {
  const py::object given = take(name);
  entry(name, "float", *value ? fmt::format("{:g}", **value) : "None", words(range), doc);
  if (!given.is_none()) *value = numberFrom(name, given, range);
}

void Keywords::whole(const char* name, std::int64_t* value, Range range, const char* doc) {
  const py::object given = take(name);
  entry(name, "int", fmt::format("{}", *value), words(range), doc);
  if (!given.is_none()) *value = wholeFrom(name, given, range);
}

void Keywords::whole(const char* name, std::optional<std::int64_t>* value, Range range,
                     const char* doc) {
  const py::object given = take(name);
  entry(name, "int", *value ? fmt::format("{}", **value) : "None", words(range), doc);
  if (!given.is_none()) *value = wholeFrom(name, given, range);
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
    *value = static_cast<std::uint64_t>(wholeFrom(name, given, {1, 9e18}));
  if (*value == 0) throw SettingError(name, "must be above 0; write for example '4GB'");
}

void Keywords::object(const char* name, py::object* value, const char* type, const char* doc) {
  const py::object given = take(name);
  entry(name, type, "None", "", doc);
  if (sets_) *value = given;
}

void Keywords::oneOf(const char* name, const std::vector<std::string>& choices, std::size_t* value,
                     const char* doc) {
  const py::object given = take(name);
  const std::string all = fmt::format("'{}'", fmt::join(choices, "', '"));
  entry(name, all, "'" + choices[*value] + "'", "", doc);
  if (given.is_none()) return;
  if (!py::isinstance<py::str>(given)) wrongType(name, "expects one of " + all);
  const std::string text = textFrom(given, name);
  const auto found = std::find(choices.begin(), choices.end(), text);
  if (found == choices.end())
    throw SettingError(name, fmt::format("must be one of {}, got '{}'", all, text));
  *value = static_cast<std::size_t>(found - choices.begin());
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
