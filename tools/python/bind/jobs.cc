// A run in shares as the jobs of an engine.
#include "report/jobs.h"

#include <filesystem>

#include "bind/errors.h"
#include "bind/keywords.h"
#include "bind/lists.h"
#include "bind/meshes.h"
#include "bind/volumes.h"
#include "core/share.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct JobsOptions {
  py::object first = py::none(), join = py::none();
  std::string folder, name = "innermap";
  double seconds = 0, firstSeconds = 0, joinSeconds = 0;
  std::uint64_t tasks = 1, cores = 1, memory = 0, firstMemory = 0, joinMemory = 0;

  void describe(Keywords& k) {
    constexpr double kLongest = 1e8, kMostCores = 1e4, kMostBytes = 1e15;
    k.number("tasks", &tasks, {1, static_cast<double>(Share::kMost)}, "how many shares there are");
    k.object("first", &first, "Sequence[str]",
             "words of a command that must end before the shares begin; not for .txt");
    k.object("join", &join, "Sequence[str]", "words of the command once all shares are made");
    k.number("seconds", &seconds, {0, kLongest}, "that a share is expected to take");
    k.number("memory", &memory, {0, kMostBytes}, "bytes that a share is expected to take");
    k.number("first_seconds", &firstSeconds, {0, kLongest}, "that `first` is expected to take");
    k.number("first_memory", &firstMemory, {0, kMostBytes},
             "bytes that `first` is expected to take");
    k.number("join_seconds", &joinSeconds, {0, kLongest}, "that joining is expected to take");
    k.number("join_memory", &joinMemory, {0, kMostBytes}, "bytes that joining is expected to take");
    k.number("cores", &cores, {1, kMostCores}, "that a share uses");
    k.text("folder", &folder, "where commands run; the current one if not given");
    k.text("name", &name, "what the engine calls it");
  }
};

py::object writeJobsFile(const Arguments& a, JobsOptions& o) {
  Jobs jobs;
  const std::string path = pathFrom(a[0], "path");
  jobs.command = textsFrom(a[1], "command");
  if (jobs.command.empty()) wrongValue("command", "is empty");
  jobs.first = textsFrom(o.first, "first");
  jobs.join = textsFrom(o.join, "join");
  jobs.folder = o.folder.empty() ? std::filesystem::current_path().string() : o.folder;
  jobs.name = o.name;
  jobs.tasks = o.tasks;
  jobs.beginning = {o.firstSeconds, o.firstMemory};
  jobs.task = {o.seconds, o.memory};
  jobs.joining = {o.joinSeconds, o.joinMemory};
  jobs.cores = o.cores;
  const py::gil_scoped_release unlocked;
  writeJobs("path", path, jobs);
  return py::none();
}

}  // namespace

void bindJobs(py::module_& m) {
  static const std::string kDoc =
      "Writes a run in shares for an engine, as --jobs of the program does: .txt a command a line "
      "(GNU parallel, OpenCue's cuecmd, PDG), .sh or .sbatch a script that submits a job array to "
      "Slurm, and the join after it, .json or .yaml an OpenJD template. Raises SettingError, "
      "FileError.\n\n"
      "path: the file.\n\n"
      "command: words of the command of a share, to which --share K/N is added. A task asks for " +
      marginsText() + ".";
  define<JobsOptions>(m, {"jobs", "path, command", kDoc.c_str()},
                      [](const Arguments& a, JobsOptions& o) { return writeJobsFile(a, o); });
}

}  // namespace innermap::python
