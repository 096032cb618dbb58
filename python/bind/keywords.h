// Keyword arguments from one table: it sets them, and writes the signature and the docstring.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bind/call.h"

namespace innermap::python {

struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
};

// A function's Options struct has `void describe(Keywords& k)`, which names all its fields. Values
// that are there when it is called are the defaults; None always means the default.
class Keywords {
 public:
  Keywords() = default;  // describes
  Keywords(std::string function, pybind11::dict given)
      : function_(std::move(function)), given_(std::move(given)), sets_(true) {}

  void number(const char* name, double* value, Range range, const char* doc);
  void number(const char* name, std::optional<double>* value, Range range, const char* doc);
  template <class Integer>
  void count(const char* name, Integer* value, Range range, const char* doc) {
    std::int64_t number = static_cast<std::int64_t>(*value);
    whole(name, &number, range, doc);
    *value = static_cast<Integer>(number);
  }
  template <class Integer>
  void count(const char* name, std::optional<Integer>* value, Range range, const char* doc) {
    std::optional<std::int64_t> number;
    if (*value) number = static_cast<std::int64_t>(**value);
    whole(name, &number, range, doc);
    if (number) *value = static_cast<Integer>(*number);
  }
  void flag(const char* name, bool* value, const char* doc);
  void flag(const char* name, std::optional<bool>* value, const char* doc);
  void text(const char* name, std::string* value, const char* doc);
  void bytes(const char* name, std::uint64_t* value, const char* doc);  // 4000000000 or "4GB"
  // type: as in a stub. The function looks at the object itself; None if not given.
  void object(const char* name, pybind11::object* value, const char* type, const char* doc);
  // One of some words.
  template <class Enum>
  void choice(const char* name, Enum* value, const std::vector<std::pair<const char*, Enum>>& words,
              const char* doc) {
    std::vector<std::string> names;
    std::size_t at = 0;
    for (std::size_t i = 0; i < words.size(); ++i) {
      names.emplace_back(words[i].first);
      if (words[i].second == *value) at = i;
    }
    oneOf(name, names, &at, doc);
    *value = words[at].second;
  }

  // Once all are named: throws TypeError for a keyword that is none of them.
  void finish() const;

  std::string signature() const;  // "tolerance=0.001, seed=1"
  std::string docs() const;       // a paragraph each

 private:
  pybind11::object take(const char* name);  // None if not given
  void entry(const char* name, const std::string& type, const std::string& literal,
             const std::string& range, const char* doc);
  void whole(const char* name, std::int64_t* value, Range range, const char* doc);
  void whole(const char* name, std::optional<std::int64_t>* value, Range range, const char* doc);
  void oneOf(const char* name, const std::vector<std::string>& words, std::size_t* value,
             const char* doc);

  std::string function_;
  pybind11::dict given_;
  bool sets_ = false;
  std::vector<std::string> names_;
  std::string signature_, docs_;
};

// Positional arguments of a call, in the order of the signature; with a "*name" among them all that
// were given.
using Arguments = std::vector<pybind11::object>;

// positional: "V, F, values", "self, X", "*mesh", "mesh, path=None" (None where it is not given).
struct Function {
  const char* name;
  const char* positional;
  const char* doc;
};

using GeneralBody = std::function<pybind11::object(const Arguments&, const pybind11::dict&)>;
void defineFunction(pybind11::handle scope, const Function& function, const Keywords& described,
                    GeneralBody body);

// Defines a function of a module, or a method of a class where the first argument is `self`. body:
// pybind11::object(const Arguments& arguments, Options& options).
template <class Options, class Body>
void define(pybind11::handle scope, const Function& function, Body body) {
  Keywords described;
  Options defaults;
  defaults.describe(described);
  defineFunction(scope, function, described,
                 [body, name = std::string(function.name)](const Arguments& arguments,
                                                           const pybind11::dict& given) {
                   Options options;
                   Keywords keywords(name, given);
                   options.describe(keywords);
                   keywords.finish();
                   return pybind11::object(body(arguments, options));
                 });
}

struct NoOptions {
  void describe(Keywords&) {}
};

// "name(positional)\n--\n\ndoc": what pybind11's own def() takes for a docstring that
// inspect.signature understands.
std::string documented(const char* signature, const char* doc);

}  // namespace innermap::python
