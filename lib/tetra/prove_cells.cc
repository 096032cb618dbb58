// Cells proven right side out, and not to overlap.
#include <fmt/format.h>

#include <optional>
#include <vector>

#include "innermap/core/run.h"
#include "innermap/tetra/cells.h"
#include "innermap/tetra/hexahedralize.h"
#include "mesh/cover_once.h"
#include "tetra/detail/prove_with.h"

namespace innermap {
namespace {

constexpr std::size_t kProofBlock = 4096;

void proveTetrahedra(const CellMesh& mesh, CellProof& out) {
  const std::size_t count = mesh.tetrahedra.size();
  std::vector<CellProof> parts((count + kProofBlock - 1) / kProofBlock);
  parallelBlocks(count, kProofBlock, [&](std::size_t begin, std::size_t end) {
    CellProof& part = parts[begin / kProofBlock];
    for (std::size_t t = begin; t < end; ++t) {
      const Sign s = signOf(mesh.vertices, mesh.tetrahedra[t], part.exact);
      part.inverted += s == Sign::negative || s == Sign::zero;
      part.undecided += s == Sign::undecided;
    }
  });
  for (const CellProof& part : parts) {
    out.inverted += part.inverted;
    out.undecided += part.undecided;
    out.exact += part.exact;
  }
}

void proveCover(const CellMesh& mesh, std::optional<CellBoundary>& boundary, CellProof& out) {
  if (!boundary) boundary = cellBoundary(mesh);
  out.boundary = boundary->triangles;
  if (!boundary->paired) return;
  const CoverCheck cover = checkCover(mesh.vertices, out.boundary);
  out.exact += cover.exact;
  out.meetings = cover.crossings + cover.meetings + cover.doubled;
  if (cover.overlaps())
    out.overlap = CellProof::Overlap::some;
  else if (cover.once())
    out.overlap = CellProof::Overlap::none;
}

std::string places(std::size_t count) {
  return fmt::format("{} place{}", count, count == 1 ? "" : "s");
}

std::string cellsOf(std::size_t count, const CellProof& proof) {
  return fmt::format("{} of the {} cells", count, proof.cells);
}

}  // namespace

CellProof proveCells(const CellMesh& mesh) {
  std::optional<CellBoundary> boundary;
  return proveWith(mesh, boundary);
}

CellProof proveWith(const CellMesh& mesh, std::optional<CellBoundary>& boundary) {
  CellProof out;
  out.cells = mesh.tetrahedra.size() + mesh.hexahedra.size();
  proveTetrahedra(mesh, out);
  const HexahedronCheck hexahedra = checkHexahedra(mesh);
  out.inverted += hexahedra.inverted;
  out.undecided += hexahedra.undecided;
  out.exact += hexahedra.exact;
  if (out.rightSideOut() && mesh.hexahedra.empty()) proveCover(mesh, boundary, out);
  return out;
}

std::string statementOf(const CellProof& proof) {
  if (proof.cells == 0) return "There are no cells.";
  if (!proof.rightSideOut()) {
    std::string out;
    if (proof.inverted > 0)
      out = cellsOf(proof.inverted, proof) + (proof.inverted == 1 ? " is" : " are") +
            " inverted or flat, proven.";
    if (proof.undecided > 0)
      out += (out.empty() ? "" : " ") + ("Whether " + cellsOf(proof.undecided, proof)) +
             (proof.undecided == 1 ? " is" : " are") + " inverted is not decided.";
    return out;
  }
  std::string out = fmt::format("Proven of the {} cells as written: none is inverted", proof.cells);
  switch (proof.overlap) {
    case CellProof::Overlap::none:
      return out + ", and no two overlap.";
    case CellProof::Overlap::some:
      return out + "; but some overlap, as their boundary passes through itself at " +
             places(proof.meetings) + ".";
    case CellProof::Overlap::unknown:
      break;
  }
  out += ". That is local: cells may still overlap";
  if (proof.meetings > 0) out += ", as their boundary touches itself at " + places(proof.meetings);
  return out + ".";
}

std::string linearMapStatement(const CellProof& from, const CellProof& to) {
  // Asked of tetrahedra alone: on a hexahedron no map is linear.
  if (from.boundary.empty() || to.boundary.empty()) return "";
  if (from.oneToOne() && to.oneToOne())
    return "The same holds for the cells that they came from: the map that is linear on them is "
           "one-to-one, globally.";
  if (from.rightSideOut() && to.rightSideOut())
    return "The same holds for the cells that they came from: the map that is linear on them is "
           "one-to-one on each cell; whether it is so globally is not proven.";
  return "";
}

}  // namespace innermap
