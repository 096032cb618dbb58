#include "command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <numeric>

#include "lists.h"
#include "report/parts.h"
#include "spelling.h"

namespace innermap::tool {
namespace {

// The bound variable's value before parsing, as the help shows it.
std::string defaultOf(const Target& target) {
  struct Visitor {
    std::string operator()(const int* v) const { return fmt::format("{}", *v); }
    std::string operator()(const std::uint64_t* v) const { return fmt::format("{}", *v); }
    std::string operator()(const double* v) const { return fmt::format("{:.6g}", *v); }
    std::string operator()(const std::string* v) const { return *v; }
    std::string operator()(const SettingChoice& v) const { return v.words[v.now()]; }
    std::string operator()(const Cut* v) const { return v->axis || v->at ? textOf(*v) : ""; }
    std::string operator()(const void*) const { return ""; }  // flags, lists, what may be absent
  };
  return std::visit(Visitor{}, target);
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t(0));
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

void addOption(std::vector<Option>& table, Option option) {
  option.defaultText = defaultOf(option.target);
  if (const auto* choice = std::get_if<SettingChoice>(&option.target))
    option.choices = choice->words;
  table.push_back(std::move(option));
}

// One option or argument in CLI11, which only cuts the command line into values: the texts go to
// `given`, and are parsed strictly afterwards.
struct Given {
  const Option* option = nullptr;
  std::vector<std::string> values;
  bool flag = false;
};

CLI::Option* declare(CLI::App& app, Given& given) {
  const Option& o = *given.option;
  std::string names = fmt::format("{}", fmt::join(spellings(o.name), ","));
  if (!o.formerName.empty()) names += "," + o.formerName;
  if (!o.shortName.empty()) names = o.shortName + "," + names;
  if (o.isFlag()) return app.add_flag(names, given.flag);
  if (!o.impliedValue.empty())
    return app.add_flag(names + "{" + o.impliedValue + "}", given.values);
  if (o.isList())
    return app.add_option(names, given.values)->expected(1, CLI::detail::expected_max_vector_size);
  // A positional list would swallow the arguments of those after it.
  if (o.isPositional())
    return app.add_option_function<std::string>(
        names, [&given](const std::string& text) { given.values = {text}; });
  return app.add_option(names, given.values)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

std::string nameFor(const std::string& command) { return "innermap " + command; }

[[noreturn]] void refuse(const Command& command, const std::string& what) {
  throw UsageError(fmt::format("{}; see '{} --help'", what, nameFor(command.name())));
}

// What is left over after parsing: a mistyped option, or too many arguments.
void refuseLeftOvers(const Command& command, const std::vector<Option>& all,
                     const std::vector<std::string>& rest) {
  if (rest.empty()) return;
  std::vector<std::string> known;
  for (const Option& o : all) {
    if (o.isPositional()) continue;
    known.push_back(o.name);
    if (!o.shortName.empty()) known.push_back(o.shortName);
  }
  for (const std::string& text : rest) {
    if (text.size() < 2 || text[0] != '-' || text == "--") continue;
    const std::string name = text.substr(0, text.find('='));
    refuse(command, fmt::format("unknown option '{}'{}", name, didYouMean(name, known)));
  }
  refuse(command, fmt::format("unexpected argument '{}'", rest.front()));
}

void take(const Command& command, const Given& given, CommonOptions& common) {
  const Option& o = *given.option;
  if (o.isFlag()) {
    if (given.flag) *std::get<bool*>(o.target) = o.sets;
    return;
  }
  const bool parts = std::holds_alternative<Cut*>(o.target) && arePartsOfACut(given.values);
  if (given.values.size() > 1 && !o.isList() && !parts)
    refuse(command, o.name + " is given more than once");
  if (given.values.empty()) {
    if (o.required)
      refuse(command, o.isPositional()
                          ? o.name + " is missing (" + o.help + ")"
                          : fmt::format("{} {} is missing ({})", o.name, o.placeholder, o.help));
    return;
  }
  const std::string& text = given.values.front();
  if (!o.isPositional() && text.size() > 2 && text.compare(0, 2, "--") == 0)
    refuse(command, fmt::format("{} needs a value, not '{}'", o.name, text));
  for (const std::string& value : given.values) parseInto(o, value);
  common.given[o.name] = given.values.back();
}

}  // namespace

OptionBuilder Command::positional(const std::string& name, Target target, const std::string& help) {
  Option o;
  o.name = name;
  o.placeholder = name;
  o.help = help;
  o.required = o.isInput = true;
  o.target = std::move(target);
  options_.push_back(std::move(o));
  return {options_, options_.size() - 1};
}

OptionBuilder Command::option(const std::string& name, const std::string& placeholder,
                              Target target, const std::string& help) {
  Option o;
  o.name = name;
  o.placeholder = placeholder;
  o.help = help;
  o.group = group_;
  o.target = std::move(target);
  addOption(options_, std::move(o));
  return {options_, options_.size() - 1};
}

std::string optionName(const std::string& setting) {
  std::string name = "--" + setting;
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

void Command::settings(const std::vector<Setting>& described) {
  for (const Setting& s : described) setting(s);
}

OptionBuilder Command::setting(const Setting& s) {
  std::string name = optionName(s.name);
  const bool* const* flagged = std::get_if<bool*>(&s.value);
  const bool off = flagged && **flagged;
  if (off) name = optionName("no_" + s.name);
  const Target target = std::visit([](const auto& value) -> Target { return value; }, s.value);
  OptionBuilder added = option(name, s.placeholder, target, withNames(s.help, optionName));
  Option& made = options_.back();
  made.sets = !off;
  if (!s.formerName.empty()) made.formerName = optionName(s.formerName);
  made.unit = s.unit;
  made.range = s.range;
  made.automatic = s.automatic;
  made.advanced = s.advanced;
  if (!s.fallback.empty()) made.defaultText = withNames(s.fallback, optionName);
  return added;
}

OptionBuilder Command::flag(const std::string& name, bool* target, const std::string& help) {
  return option(name, "", target, help);
}

OptionBuilder Command::outputFile(std::string* path, std::vector<std::string> endings,
                                  const std::string& help) {
  return option("--output", "FILE", path, help)
      .shortName("-o")
      .required()
      .writes(std::move(endings));
}

OptionBuilder Command::outputFolder(std::string* path, const std::string& help) {
  return option("--output", "FOLDER", path, help).shortName("-o").required();
}

OptionBuilder Command::limitTime(const std::string& help) {
  return option("--max-time", "S", maxTime_.get(), help).unit("seconds").above(0);
}

void Command::addSpace() {
  group("axes and units");
  settings(describe(*space_));
  group("");
}

std::vector<Option> commonOptionTable(CommonOptions& common) {
  Command c("", "");
  c.option("--threads", "N", &common.threads, "number of threads; 0 means all cores")
      .range(0, 1024);
  c.option(
       "--max-memory", "SIZE", &common.maxMemory,
       "use no more memory than this, such as 800M or 4GB; refuse to start a run that needs more")
      .defaults("80% of the machine's");
  c.option("--cpu-target", "NAME", &common.cpuTarget,
           fmt::format("use only the vector instructions of {}, to get the same bits on newer "
                       "processors",
                       fmt::join(cpuNames(), " or ")))
      .defaults("this processor's best")
      .advanced();
  c.flag("--dry-run", &common.dryRun,
         "say what the run would do, how much memory it needs, and how much time if that is known "
         "within a factor of two; write nothing");
  c.option("--report", "FILE", &common.report, "write the report, with figures and times, as JSON");
  c.flag("--json", &common.json, "print the report on stdout instead of other text");
  c.option("--html", "FILE", &common.html,
           "also write a page for any browser, in one file: numbers with their meaning, surfaces, "
           "sections; report.html beside the outputs, or FILE")
      .implied(kPageBesideOutputs);
  c.flag("--strict", &common.strict,
         "end with exit code 1 if the verdict is not met; write all files nevertheless");
  c.flag("--quiet", &common.quiet, "print nothing on stderr but errors").shortName("-q");
  c.flag("--verbose", &common.verbose,
         "print a line on stderr as each stage begins, with the seconds, and at the end the "
         "longest stages");
  c.flag("--help", &common.help, "show help on the usual options").shortName("-h");
  c.flag("--help-all", &common.helpAll, "show help on every option");
  c.flag("--version", &common.version, "show the program's version").shortName("-V");
  return c.options();
}

std::vector<Option> allOptions(const Command& command, CommonOptions& common) {
  std::vector<Option> all = command.options();
  const std::size_t own = all.size();
  for (Option& o : commonOptionTable(common)) {
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(own);
    if (std::none_of(all.begin(), end, [&](const Option& other) { return other.name == o.name; }))
      all.push_back(std::move(o));
  }
  return all;
}

namespace {

bool usesName(const std::vector<std::string>& arguments, const std::string& name) {
  return std::any_of(arguments.begin(), arguments.end(), [&](const std::string& text) {
    return text == name || text.rfind(name + "=", 0) == 0;
  });
}

}  // namespace

void parseArguments(const Command& command, CommonOptions& common,
                    const std::vector<std::string>& arguments) {
  common.arguments = arguments;
  std::vector<Option> all = allOptions(command, common);

  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  std::vector<Given> given(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    given[i].option = &all[i];
    declare(app, given[i]);
  }
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    app.parse(reversed);
  } catch (const CLI::ArgumentMismatch&) {
    // The only arity here is one value, so the last argument is an option without its value.
    refuse(command, arguments.back() + " needs a value");
  } catch (const CLI::ParseError& error) {
    refuse(command, error.what());
  }
  for (const Given& g : given)
    for (bool* flag : {&common.help, &common.helpAll, &common.version})
      if (g.flag && std::get<bool*>(g.option->target) == flag) *flag = true;
  if (common.help || common.helpAll || common.version) return;
  refuseLeftOvers(command, all, app.remaining());
  for (const Given& g : given) take(command, g, common);
  for (const Option& o : all)
    for (const std::string& former : commaList(o.formerName))
      if (usesName(arguments, former)) common.notes.push_back(former + " is now called " + o.name);
}

std::string didYouMean(const std::string& typed, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, typed.size() / 3) + 1;
  for (const std::string& name : known) {
    const bool prefix = typed.size() >= 4 && name.compare(0, typed.size(), typed) == 0;
    const std::size_t distance = prefix ? 1 : editDistance(typed, name);
    if (distance >= least || distance >= name.size()) continue;
    least = distance;
    best = name;
  }
  return best.empty() ? "" : "; did you mean " + best + "?";
}

}  // namespace innermap::tool
