#include "report/report_sections.h"

#include <algorithm>

#include "innermap/core/error.h"
#include "innermap/evaluate/grids.h"
#include "innermap/fit/fit_map.h"
#include "innermap/io/exr_slices.h"
#include "innermap/io/pictures.h"
#include "innermap/io/volume_texture.h"
#include "innermap/lattice/outer_surface.h"
#include "innermap/levelset/level_set.h"
#include "innermap/surface/correspond.h"
#include "innermap/texture/solid_texture.h"
#include "innermap/transfer/distance_transfer.h"
#include "innermap/transfer/geometry.h"
#include "report/figures.h"
#include "report/report_figures.h"
#include "report/sequence_table.h"

namespace innermap {
namespace {

// Those of a density whose name may be any.
CarriedMass anyMass() {
  CarriedMass out;
  out.name = "*";
  return out;
}

// Results of which nothing is known.
struct Unknown {
  MapGrids grids;
  SolidTexture texture;
};

std::vector<ReportSection> mapSections(const Unknown& u) {
  const std::vector<std::string> mesh = {"path", "vertices", "triangles", "boundary_loops",
                                         "caps", "genus",    "volume",    "diagonal"};
  return {
      {"boundary_error",
       "Boundary error",
       "How far the map misses the target on the boundary. Inside a map of one step the error is "
       "nowhere larger.",
       boundaryErrorFigures(nullptr),
       {"rms", "p99", "max"}},
      {"worst_boundary_error",
       "Boundary error of the worst frame",
       "",
       worstFigures({}),
       {"rms", "p99", "max"}},
      {"tolerance", "Tolerance", "", toleranceFigures(nullptr, ""), {"wanted", "reached", "met"}},
      {"one_to_one",
       "Is it one-to-one?",
       "What innermap checked, and what it found.",
       figures(Injectivity{}),
       {}},
      {"verification",
       "Verification",
       "The proofs that the map's file claims, made again.",
       figures(Verification{}),
       {"any", "holds"}},
      {"inside",
       "Points inside",
       "Random points inside the source, spread evenly, checked one by one.",
       figures(InsideFigures{}),
       {}},
      {"jacobian",
       "Change of volume",
       "The determinant of the map's derivative: 1 keeps volume, 0 or less folds.",
       jacobianFigures(u.grids),
       {"min", "max", "folded_fraction"}},
      {"repair", "Repaired folds", "", repairFigures(u.grids), {}},
      {"energy", "Energy", "", merged({energyFigures(u.grids), figures(LameConstants{})}), {}},
      {"source", "Source", "", figures(ReportMesh{}), mesh},
      {"target", "Target", "", figures(ReportMesh{}), mesh},
      {"laid", "Source laid onto the target",
       "A mesh of the source's triangles on the target's surface: the map goes there.",
       figures(ReportMesh{}), mesh},
      {"solve",
       "Charges and their solve",
       "The map is an affine function plus weight / distance, summed over the charges.",
       merged({figures(MapSolve{}), choiceFigures(0, false), solveFigures(u.texture)}),
       {"method", "sources", "collocation"}},
      {"steps",
       "Steps",
       "A map in steps is several harmonic maps one after the other.",
       stepFigures({}),
       {}},
      {"grid",
       "Grid",
       "",
       merged({gridFigures(SolidGrids{}), targetGridFigures(DistanceTransfer{})}),
       {}},
      {"field", "Field", "Of harmonic fields.", fieldFigures(0, 0), {}},
      {"energies",
       "Energies",
       "Of a sequence, one value a frame.",
       columns(std::vector<SequenceRow>(), [](const SequenceRow& r) { return figures(r); }),
       {}},
      {"frames",
       "Frames",
       "Of an animation; lists have one value a frame.",
       merged({frameFigures({}), deformedFigures({}), finishedFigures(0), leftFigures(0),
               frameSeconds(0, 0, 0), judgedFigures(0, {})}),
       {}},
      {"stages",
       "Stages",
       "What the stages of the job took beside what was expected.",
       figures(StageFigures{}),
       {}},
      {"farm", "Farm", "How a run in shares was made.", figures(FarmFigures{}), {}}};
}

std::vector<ReportSection> carrySections(const Unknown& u) {
  return {
      {"inverse",
       "Inverse",
       "Of the inverse map at the target's voxels.",
       figures(InverseStatistics{}),
       {}},
      {"mass", "Mass", "Of each density, by its name.", massFigures(anyMass()), {}},
      {"densities", "Densities", "Of each density, by its name.", densityFigures(anyMass()), {}},
      {"resampling",
       "Resampling",
       "Voxels of the input and the output.",
       figures(ResamplingFigures{}),
       {}},
      {"pull", "Pull", "", pulledFigures(0), {}},
      {"geometry",
       "Geometry",
       "Points, directions and cells that were carried.",
       figures(CarriedGeometry{}),
       {}},
      {"distance",
       "Distance",
       "Fields of distance.",
       merged({figures(DistanceTransfer{}), distanceRangeFigures({})}),
       {}},
      {"texture",
       "Texture",
       "Images and volume textures, read or written.",
       merged({figures(ReportImage{}), figures(VolumeTextureResult{}), layoutFigures(""),
               figures(ReportImport{})}),
       {}},
      {"seams",
       "Seams",
       "Of a texture's charts.",
       merged({figures(SeamFigures{}), blendFigures(0, 0)}),
       {}},
      {"surface", "Surface", "Errors at the surface.", surfaceFigures(u.texture), {}},
      {"slices", "Slices", "", figures(ExrSliceResult{}), {}},
      {"section", "Section", "A picture's plane and colours.", figures(SectionResult{}), {}}};
}

std::vector<ReportSection> meshSections() {
  return {{"correspondence",
           "Correspondence",
           "Of one surface laid on another.",
           correspondenceFigures(nullptr),
           {}},
          {"outer_surface",
           "Outer surface",
           "The closed surface that is mapped in place of a mesh that runs through itself.",
           outerSurfaceFigures({}),
           {}},
          {"sphere",
           "Sphere",
           "Of a layout on the sphere.",
           merged({figures(LayoutQuality{}), shellFigures(0)}),
           {}},
          {"findings", "Findings", "What is wrong with the mesh.", findingFigures("*", 0), {}},
          {"level_set", "Level set", "The grid beside the mesh.", figures(LevelSetCheck{}), {}}};
}

}  // namespace

Figures merged(std::initializer_list<Figures> parts) {
  Figures out;
  for (const Figure& f : together(parts)) {
    const auto same = std::find_if(out.begin(), out.end(),
                                   [&](const Figure& other) { return other.key == f.key; });
    if (same == out.end())
      out.push_back(f);
    else if (same->value.index() != f.value.index())
      throw Error("two figures of different types are called " + f.key);
  }
  return out;
}

std::vector<ReportSection> reportSections() {
  const Unknown unknown;
  std::vector<ReportSection> out;
  const auto add = [&](const std::vector<ReportSection>& part) {
    out.insert(out.end(), part.begin(), part.end());
  };
  add(mapSections(unknown));
  add(carrySections(unknown));
  add(meshSections());
#if INNERMAP_TETRA
  add(cellSections());
#endif
#if INNERMAP_STUDY
  add(studySections());
#endif
  out.push_back({"memory_after_bytes", "Memory after stages", "", memoryFigures("*", 0), {}});
  out.push_back(
      {"", "", "", merged({outsideFigures(0), stoppedByTimeFigures(), planFigures(1, 0)}), {}});
  return out;
}

}  // namespace innermap
