// Meshes of tetrahedra and hexahedra in the terms of reports and the terminal.
#pragma once

#include "context.h"
#include "innermap/tetra/cells.h"
#include "innermap/tetra/hexahedralize.h"

namespace innermap::tool {

// "cells": counts, inverted ones, what is proven, angles or Jacobians with their histogram; two or
// three lines.
void reportCells(const CellMesh& mesh, const CellQuality& quality, const CellProof& proof,
                 Context& context);

// "boundary"; a line.
void reportBoundaryFit(const BoundaryFit& fit, Context& context);

}  // namespace innermap::tool
