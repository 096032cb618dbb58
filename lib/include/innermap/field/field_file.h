// Fields on disk: one PLY file, binary little endian, that point viewers show.
//
//   comment innermap field 1
//   comment affine_center ..., comment affine_K ...: the affine part, 17 digits
//   comment step_sources N1 N2 ...: of a map in steps (then "field 2"), how many of the vertices,
//     in order, are each step's; every step has an affine part, in order
//   comment KEY VALUE: settings and results of the fit
//   element vertex N: double x y z (sources), double w0 ... wK-1 (weights)
//   element boundary_vertex V: double x y z, double tx ty tz (source mesh and its target)
//   element boundary_face T: list uchar int vertex_indices
//
// The boundary stands in the file so that it is all one needs to evaluate the map on its solid.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "innermap/field/fit.h"
#include "innermap/field/harmonic_field.h"

namespace innermap {

// What is known of a field or a map beside its numbers, as its file keeps it: keys of [a-z0-9_],
// each with a text without line breaks. Read here alone as what it stands for.

using Facts = std::vector<std::pair<std::string, std::string>>;

// Nothing where there is no such key; of numbers and flags also where the text is none.
std::optional<std::string> factText(const Facts& facts, std::string_view key);
std::optional<double> factNumber(const Facts& facts, std::string_view key);
std::optional<bool> factFlag(const Facts& facts, std::string_view key);

// As facts keep it: to the nine digits that tell figures apart.
std::string textOfFact(double number);
std::string textOfFact(bool flag);

struct FieldFile {
  std::vector<HarmonicField> steps;  // one, unless it is a map composed of several; of each the
                                     // same channels
  Facts facts;                       // keys of [a-z0-9_]; values without line breaks
  Points boundary, boundaryTarget;   // same size, or both empty
  std::vector<std::array<int, 3>> boundaryTriangles;
};

// Throws FileError when the file cannot be written; it appears whole or not at all.
void writeField(const std::string& path, const FieldFile& file);

// Gives the same field to the last bit. Throws FileError for anything that is not such a file,
// whole; sizes are checked against the file's before allocating.
FieldFile readField(const std::string& path);

// Whether a file starts as one; false for what cannot be read. Tells a map from a mesh, both .ply.
bool isFieldFile(const std::string& path);

// What the file of a map or a field says of its fit, written and read here alone.

struct FitFacts {
  BoundaryError error;                       // NaN and no samples where the file does not say
  std::optional<double> tolerance, reached;  // as ToleranceOutcome has them
  std::optional<bool> met;
};

// rms, p99, max and samples of the error; the tolerance.
Facts factsOf(const BoundaryError& error);
Facts factsOfTolerance(double wanted, std::optional<double> reached, bool met);

FitFacts fitFacts(const Facts& facts);

}  // namespace innermap
