// What `sequence` tells of each frame: as CSV, chart, report and text.
#pragma once

#include <string>
#include <vector>

#include "innermap/evaluate/grids.h"
#include "innermap/field/fit.h"
#include "innermap/fit/frame_fitter.h"
#include "report/figures.h"
#include "report/report.h"
#include "report/report_figures.h"
#include "report/svg_chart.h"

namespace innermap {

struct SequenceRow {
  FrameFile file;
  double harmonic = 0, deformation = 0, deformationMean = 0;
  BoundaryError error;
  bool misses = false;  // the tolerance
  double jacobianMin = 0, jacobianMax = 0, folded = 0, outside = 0;
  double volume = 0;  // of the frame's solid, world units cubed; 0 when its parts cancel
  ProofFigures proof;
  std::string statement;  // of one-to-one; empty where nothing was to be proven
  double seconds = 0;
  std::string broken;  // why; all figures are then missing
};

// Without its file, what it is judged by and its seconds.
SequenceRow sequenceRow(const FrameFit& fit, const MapGrids& grids);

// Calls visit(key, member, name, meaning, unit) for each number that the row and its part have.
template <class Row, class Visit>
void eachNumber(Row& r, const Visit& visit) {
  constexpr auto kNone = FigureUnit::none;
  visit("harmonic", r.harmonic, "harmonic energy", "3 for a rigid motion", kNone);
  visit("deformation", r.deformation, "deformation energy", "0 for a rigid motion", kNone);
  visit("deformation_mean", r.deformationMean, "deformation, mean", "of a unit of volume", kNone);
  visit("boundary_rms", r.error.rms, "boundary error", "root mean square", kDiagonals);
  visit("boundary_p99", r.error.p99, "boundary error", "99% within", kDiagonals);
  visit("boundary_max", r.error.max, "boundary error", "largest", kDiagonals);
  visit("jacobian_min", r.jacobianMin, "least change of volume", "0 or less: folded there", kNone);
  visit("jacobian_max", r.jacobianMax, "greatest change of volume", "", kNone);
  visit("folded_fraction", r.folded, "folded", "of the volume", kShare);
  visit("volume", r.volume, "volume", "of the frame's solid", FigureUnit::volume);
  visit("outside_fraction", r.outside, "outside", "of the inside", kShare);
}

// Not known of a frame that is broken; of its proof without places.
Figures figures(const SequenceRow& row);
// The largest boundary errors of all rows.
Figures worstFigures(const std::vector<SequenceRow>& rows);

// All frames in order, those that are broken too, with their seconds. rows: the good ones, in
// order.
std::vector<SequenceRow> withBroken(const std::vector<SequenceRow>& rows,
                                    const std::vector<FrameResult>& results);

// CSV after RFC 4180 with a line of names; fields of broken frames are empty but for the last.
// Throws FileError.
void writeSequenceTable(const std::string& path, const std::vector<SequenceRow>& rows);

// Both energies over the frames' numbers.
SvgChart sequenceChart(const std::vector<SequenceRow>& rows, const std::string& rest);

// The report's "energies" and its worst boundary error.
void fillReport(const std::vector<SequenceRow>& rows, Report& report);

std::string sequenceHeader();
std::string sequenceLine(const SequenceRow& row);

}  // namespace innermap
