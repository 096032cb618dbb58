// A harmonic field together with the solid that it fills: what its file holds.
#pragma once

#include <string>
#include <vector>

#include "innermap/boundary/boundary_pair.h"
#include "innermap/boundary/fit_harmonic.h"
#include "innermap/field/field_file.h"
#include "innermap/field/harmonic_field.h"

namespace innermap {

struct SolidField {
  HarmonicField field;
  SourceBoundary boundary;
  std::vector<std::string> names;  // of the channels
  // As its file says it: version, source, channels, span, seed, tolerance, tolerance_met,
  // boundary_error_rms, boundary_error_p99, boundary_error_max, boundary_error_samples,
  // inside_error_bound, free_share.
  Facts facts;
};

// The facts of a fit. names: of its channels, without commas or line breaks. Throws DataError for
// other names or another number of them.
Facts harmonicFacts(const HarmonicFit& fit, const HarmonicFitSettings& settings,
                    const std::string& source, const std::vector<std::string>& names);

// One PLY, see field_file.h; `innermap info` describes it. Throws FileError when it cannot be
// written; it appears whole or not at all.
void writeSolidField(const std::string& path, const SolidField& field);

// Reads it and makes the solid again. Throws FileError for what is not the file of a field with its
// boundary, DataError as makeSourceBoundary does, Cancelled.
SolidField readSolidField(const std::string& path);

// Whether facts are those of a field, and not of a map.
bool tellOfField(const Facts& facts);

}  // namespace innermap
