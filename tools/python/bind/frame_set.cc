#include "bind/frame_set.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "bind/arrays.h"
#include "bind/errors.h"
#include "bind/lists.h"
#include "bind/meshes.h"
#include "innermap/mesh/mesh_file.h"
#include "jobs/frames_job.h"
#include "report/sequence_table.h"

namespace py = pybind11;

namespace innermap::python {
void FittingOptions::describe(Keywords& k) {
  k.object("only", &only, "str", "which of the frames, by number: '12', '1-48', '1-48x2'; all");
  k.object("numbers", &numbers, "Sequence[int]",
           "of frames that are arrays: their numbers, ascending, for names of files and "
           "velocities; from 0 on if not given");
  k.settings(innermap::describe(animation));
  k.settings(innermap::only(innermap::describe(animation.space), {"up", "unit_scale"}));
  k.text("mesh", &animation.mesh, "mesh or node of glTF to read, if it has several");
  k.text("animation", &animation.animation, "animation of glTF to read, if several move the same");
  k.settings(innermap::describe(fitting));
}

Mesh restFrom(const py::object& given, const FittingOptions& options) {
  if (isPath(given))
    if (const std::string path = pathFrom(given, "source"); isGltf(path))
      return readRestPose(path, options.animation);
  return meshFrom(given, "source");
}

FrameSet::FrameSet(const py::object& given, const FittingOptions& options, const Mesh& rest)
    : rest_(rest) {
  const bool oneText = isPath(given);
  if (oneText || (py::isinstance<py::sequence>(given) && !py::isinstance<py::array>(given) &&
                  py::len(given) > 0 && isPath(py::sequence(given)[0])))
    takeFiles(given, oneText, options.animation);
  else
    takeMeshes(given);
  if (numbers_.empty()) wrongValue("frames", "is empty");
  if (!options.numbers.is_none()) number(options.numbers);
  choose(options.only);
}

Mesh FrameSet::mesh(std::size_t index) const {
  if (files_) return files_->read(index, rest_);
  Mesh out = rest_;
  out.name = fmt::format("frame {}", numbers_[index]);
  out.vertices = places_[index];
  return out;
}

FrameTable FrameSet::table(const FrameFitter& fitter,
                           const std::function<Figures(const FittedFrame&)>& each) const {
  FrameTable out;
  FrameFits fits = frameFits(
      fitter, numbers_, [&](std::size_t index) { return mesh(index); },
      [&](std::size_t index, const Mesh&, const FrameFit& fit) {
        out.warnings.try_emplace(numbers_[index], fit.warnings);
      });
  Figures row;
  FrameWatch watch;
  watch.ended = [&](std::size_t index, const FrameResult& result) {
    out.add(numbers_[index], std::exchange(row, {}), result.error);
  };
  eachFrame(wanted_, watch, [&](std::size_t index) {
    const std::shared_ptr<const FrameFit> fit = fits.at(index);
    row = each({index, {fit.get(), numbers_[index]}, fits, out.warnings[numbers_[index]]});
  });
  return out;
}

void FrameSet::takeFiles(const py::object& given, bool oneText, const AnimationSettings& settings) {
  std::vector<std::string> names;
  if (oneText)
    names.push_back(pathFrom(given, "frames"));
  else
    for (const auto& path : given) names.push_back(pathFrom(path, "frames"));
  files_ = openFrames(names, settings);
  files_->requireLike(rest_);
  numbers_ = files_->numbers;
}

void FrameSet::takeMeshes(const py::object& given) {
  if (!py::isinstance<py::iterable>(given))
    wrongType("frames", "expects paths, a pattern, or the vertices of each frame");
  for (const auto& item : given) {
    const auto object = py::reinterpret_borrow<py::object>(item);
    const std::string name = fmt::format("frames[{}]", numbers_.size());
    places_.push_back(isArrayLike(object) ? pointsFrom(object, name)
                                          : meshFrom(object, name).vertices);
    if (places_.back().size() != rest_.vertices.size())
      wrongValue(name, fmt::format("has {} vertices, the rest pose has {}", places_.back().size(),
                                   rest_.vertices.size()));
    numbers_.push_back(static_cast<std::int64_t>(numbers_.size()));
  }
}

void FrameSet::number(const py::object& numbers) {
  constexpr std::int64_t kMost = 999'999'999;  // as in names of files
  if (files_) wrongValue("numbers", "is for arrays; files have numbers of their own");
  const std::vector<std::int64_t> given = wholesFrom(numbers, "numbers", 0, kMost);
  if (given.size() != numbers_.size())
    wrongValue("numbers",
               fmt::format("has {} numbers for {} frames", given.size(), numbers_.size()));
  for (std::size_t i = 1; i < given.size(); ++i)
    if (given[i] <= given[i - 1]) wrongValue("numbers", "must ascend");
  numbers_ = given;
}

void FrameSet::choose(const py::object& only) {
  wanted_ = wantedFrames(numbers_, "only", only.is_none() ? "" : textOf(only, "only"));
}

void FrameTable::add(std::int64_t number, const Figures& row, const std::string& broken) {
  error.push_back(broken);
  for (const Figure& figure : row) {
    if (!figure.known) continue;
    if (const auto* text = std::get_if<std::string>(&figure.value))
      texts.try_emplace(figure.key, frame.size()).first->second.push_back(*text);
    else
      columns.try_emplace(figure.key, frame.size(), kNone)
          .first->second.push_back(numberOf(figure));
  }
  frame.push_back(number);
  for (auto& [name, values] : columns) values.resize(frame.size(), kNone);
  for (auto& [name, values] : texts) values.resize(frame.size());
}

void FrameTable::tell() const {
  requireOneGood(error);
  for (const std::string& text : general) warn(text);
  std::map<std::int64_t, std::string> said;
  for (const auto& [number, doubts] : warnings)
    if (!doubts.empty())
      said[number] = frameWarning(number, fmt::format("{}", fmt::join(doubts, "; ")));
  for (std::size_t i = 0; i < error.size(); ++i)
    if (!error[i].empty()) said[frame[i]] = frameLeftOut(frame[i], error[i]);
  for (const auto& [number, text] : said) warn(text);
}

py::dict FrameTable::dict() const {
  tell();
  py::dict out;
  out["frame"] = arrayOf(frame);
  for (const auto& [name, values] : columns) out[name.c_str()] = arrayOf(values);
  for (const auto& [name, values] : texts) out[name.c_str()] = values;
  out["error"] = error;
  return out;
}

Figures rowOf(const FrameFit& fit) {
  Figures row = only(figures(sequenceRow(fit, {})), {"boundary_rms", "boundary_p99", "boundary_max",
                                                     "outside_fraction", "volume"});
  row.emplace_back("folded_fraction", fit.folded(), "folded");
  return row;
}

FrameFitter fitterOf(SourceBoundary rest, const FittingOptions& o, std::uint64_t others) {
  requireMemory(framesNeed(o.fitting, others));
  return {std::move(rest), o.fitting};
}

}  // namespace innermap::python
