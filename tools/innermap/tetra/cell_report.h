// Meshes of tetrahedra and hexahedra in the terms of reports and the terminal.
#pragma once

#include "context.h"
#include "innermap/tetra/cells.h"
#include "innermap/tetra/hexahedralize.h"
#include "section_options.h"

namespace innermap::tool {

// "cells": counts, inverted ones, what is proven, angles or Jacobians with their histogram; two or
// three lines.
void reportCells(const CellMesh& mesh, const CellQuality& quality, const CellProof& proof,
                 Context& context);

// "boundary"; a line. Of the second, it is compared with the solid's surface first.
void reportBoundaryFit(const BoundaryFit& fit, Context& context);
void reportBoundary(const CellMesh& mesh, const Solid& solid, const CellProof& proof,
                    Context& context);

// The cells behind the cut, if there is a path: each in the colour of its least dihedral angle or,
// of hexahedra, its scaled Jacobian. label: a file's path.
void drawCells(const std::string& path, const CellMesh& mesh, const CellQuality& quality,
               const SectionOptions& cut, const std::string& label, Context& context);

// Timed; fields that the format cannot hold are warned of.
void writeCellFile(const std::string& path, const CellMesh& mesh, Context& context);

}  // namespace innermap::tool
