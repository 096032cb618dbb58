// The frames of an animation, as deform() and sequence() take them.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bind/keywords.h"
#include "core/figure.h"
#include "innermap/fit/frame_fitter.h"
#include "innermap/mesh/mesh_file.h"

namespace innermap::python {

void bindDeform(pybind11::module_& m);  // after bindGrids
void bindSequence(pybind11::module_& m);

struct FittingOptions {
  FrameFitterSettings fitting;
  AnimationSettings animation;
  pybind11::object only;     // which frames
  pybind11::object numbers;  // of frames that no file names

  void describe(Keywords& k);
};

// A mesh, or the rest pose of a glTF file.
Mesh restFrom(const pybind11::object& given, const FittingOptions& options);

// Columns of figures, a row a frame; a frame that cannot be used has its error and NaN.
struct FrameTable {
  std::vector<std::int64_t> frame;
  std::vector<std::string> error;
  std::map<std::string, std::vector<double>> columns;
  std::map<std::string, std::vector<std::string>> texts;
  std::vector<std::string> general;                           // warnings of no single frame
  std::map<std::int64_t, std::vector<std::string>> warnings;  // by a frame's number

  // Figures that are not known in any frame have no column.
  void add(std::int64_t number, const Figures& row, const std::string& broken);
  // Warns in Python, once a frame, of what makes it doubtful or why it is left out. Throws
  // DataError where no frame could be used.
  void tell() const;
  // The same, and the columns.
  pybind11::dict dict() const;
};

// What is told of a frame's fit alone.
Figures rowOf(const FrameFit& fit);

// One of the frames wanted: its place among all, its fit and its number, and the fits of all.
struct FittedFrame {
  std::size_t index;
  NumberedFit fit;
  FrameFits& all;
  std::vector<std::string>& warnings;  // of it
};

// From files or from arrays.
class FrameSet {
 public:
  // rest: must outlive it.
  FrameSet(const pybind11::object& given, const FittingOptions& options, const Mesh& rest);

  const std::vector<std::int64_t>& numbers() const { return numbers_; }

  // A row for each of the frames wanted, made by `each`. Without the lock of the interpreter.
  FrameTable table(const FrameFitter& fitter,
                   const std::function<Figures(const FittedFrame&)>& each) const;

 private:
  Mesh mesh(std::size_t index) const;
  void takeFiles(const pybind11::object& given, bool oneText, const AnimationSettings& settings);
  void takeMeshes(const pybind11::object& given);
  void number(const pybind11::object& numbers);
  void choose(const pybind11::object& only);

  const Mesh& rest_;
  std::unique_ptr<FrameSource> files_;
  std::vector<Points> places_;
  std::vector<std::int64_t> numbers_;
  std::vector<std::size_t> wanted_;
};

// others: memory that is needed beside it, bytes.
FrameFitter fitterOf(SourceBoundary rest, const FittingOptions& o, std::uint64_t others);

}  // namespace innermap::python
