// Keyword arguments from one table: it sets them, and writes the signature and the docstring.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bind/call.h"
#include "innermap/core/setting.h"

namespace innermap::python {

// A function's Options struct has `void describe(Keywords& k)`, which names all its fields. Values
// that are there when it is called are the defaults; None always means the default.
class Keywords {
 public:
  Keywords() = default;  // describes
  Keywords(std::string function, pybind11::dict given)
      : function_(std::move(function)), given_(std::move(given)), sets_(true) {}

  // Settings of the library, as they are described beside their structs.
  void settings(const std::vector<Setting>& described) {
    for (const Setting& s : described) setting(s);
  }
  void setting(const Setting& described);

  // Arguments that are no setting of the library. Value: of those that a Setting may have.
  template <class Value>
  void number(const char* name, Value* value, const NumberRange& range, const char* doc) {
    Setting s(name, "", value, doc);
    s.range = range;
    setting(s);
  }
  void flag(const char* name, bool* value, const char* doc);
  void flag(const char* name, std::optional<bool>* value, const char* doc);
  void text(const char* name, std::string* value, const char* doc);
  void bytes(const char* name, std::uint64_t* value, const char* doc);  // 4000000000 or "4GB"
  // type: as in a stub. The function looks at the object itself; None if not given.
  void object(const char* name, pybind11::object* value, const char* type, const char* doc);
  // One of some words.
  template <class Enum>
  void choice(const char* name, Enum* value, const std::vector<std::pair<std::string, Enum>>& words,
              const char* doc) {
    setting({name, "", choiceOf<Enum>(value, words), doc});
  }

  // Once all are named: throws TypeError for a keyword that is none of them.
  void finish() const;

  std::string signature() const;  // "tolerance=0.001, seed=1"
  std::string docs() const;       // a paragraph each

 private:
  pybind11::object take(const std::string& name);  // None if not given
  pybind11::object take(const Setting& s);         // by either of its names
  void entry(const std::string& name, const std::string& type, const std::string& literal,
             const std::string& range, const std::string& doc);
  template <class Number>
  void takeNumber(const Setting& s, const std::string& doc, const Number* now,
                  const std::function<void(Number)>& set);
  void takeChoice(const Setting& s, const std::string& doc, const SettingChoice& choice);

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

// Found by the type of its argument, which a member of that name would hide.
template <class Settings>
std::vector<Setting> described(Settings& settings) {
  return describe(settings);
}

// Settings as the library describes them, and what every long call takes.
template <class Settings>
struct SettingsOptions {
  Settings settings;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(described(settings));
    call.describe(k);
  }
};

// "name(positional)\n--\n\ndoc": what pybind11's own def() takes for a docstring that
// inspect.signature understands.
std::string documented(const char* signature, const char* doc);

}  // namespace innermap::python
