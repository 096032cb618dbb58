// The figures of every result that a report has: what each is called, what it means, in what unit,
// and what it came to. A new figure is a member of its result and a line in the function here that
// takes it; report.json, docs/report.schema.json, the page and Python's dicts follow.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/figure.h"

namespace innermap {

constexpr auto kShare = FigureUnit::share, kDiagonals = FigureUnit::diagonals,
               kSeconds = FigureUnit::seconds;

struct BoundaryError;
struct BoundaryFit;
struct Box3;
struct CarriedGeometry;
struct CarriedMass;
struct CellMesh;
struct CellProof;
struct CellQuality;
struct CompareFem;
struct DistanceTransfer;
struct ExrSliceResult;
struct HarmonicFit;
struct Hexahedralization;
struct HexahedronCheck;
struct Injectivity;
struct ProofFigures;
struct InsideFigures;
struct InverseStatistics;
struct LameConstants;
struct LayoutQuality;
struct LevelSetCheck;
struct MapFit;
struct MapGrids;
struct MapQuality;
struct MapSolve;
struct MapStep;
struct MeshCorrespondence;
struct OuterSurface;
struct Polycube;
struct Quantiles;
struct Remesh;
struct ResamplingFigures;
struct SectionResult;
struct SeamFigures;
struct ShellCorrespondence;
struct SolidGrids;
struct SolidTexture;
struct Study;
struct StudyFindings;
struct Tetrahedralization;
struct Verification;
struct VolumeTextureResult;

// -- maps and fields (map_figures.cc) --

// rms, p99, max, samples: of the surface's points that took no part in the fit.
Figures figures(const BoundaryError& error);
// "boundary_error" of a map, with what certifies it; of a harmonic field. null: what is known of
// none.
Figures boundaryErrorFigures(const MapFit* fit);
Figures boundaryErrorFigures(const HarmonicFit& fit);
// "tolerance". ended: why no more was reached.
Figures toleranceFigures(const MapFit* fit, const std::string& ended);
Figures toleranceFigures(const HarmonicFit& fit, double wanted);
// "solve"
Figures figures(const MapSolve& solve);
Figures solveFigures(const HarmonicFit& fit);
// "solve", of any fit. smooth: between the vertices, where that was a choice.
Figures choiceFigures(std::uint64_t seed, std::optional<bool> smooth = {});
// "inside"; "steps": a list each, of the steps of a map in steps.
Figures figures(const InsideFigures& inside);
Figures stepFigures(const std::vector<MapStep>& steps);
// "one_to_one"
Figures figures(const Injectivity& known);
// "one_to_one" too: of what is proven.
Figures figures(const ProofFigures& proof);
// "verification"
Figures figures(const Verification& made);
// "field"
Figures fieldFigures(double span, double freeShare);
// "energy", "jacobian", "repair", "grid" of an evaluated map.
Figures energyFigures(const MapGrids& grids);
Figures figures(const LameConstants& lame);
Figures jacobianFigures(const MapGrids& grids);
Figures repairFigures(const MapGrids& grids);
Figures gridFigures(const SolidGrids& grids);
// "grid" of any other volume.
Figures gridFigures(double voxelSize, std::uint64_t activeVoxels, std::uint64_t interiorVoxels);

// -- surfaces (surface_figures.cc) --

// Middles of boxes and their diagonals, a list each.
Figures placeFigures(const std::vector<Box3>& boxes);
// "outer_surface": what was taken in place of a mesh that crosses itself.
Figures outerSurfaceFigures(const std::optional<OuterSurface>& outer);
Figures figures(const Quantiles& quantiles);
Figures figures(const LayoutQuality& quality);
// "correspondence". null: what is known of none.
Figures correspondenceFigures(const MeshCorrespondence* map);
// "boundary_map" of hexahedra
Figures boundaryMapFigures(const MapQuality& quality);

// -- cells (tetra/cell_figures.cc) --

Figures figures(const CellProof& proof);
// "cells"
Figures cellFigures(const CellMesh& mesh, const CellQuality& quality, const CellProof& proof);
Figures figures(const BoundaryFit& fit);                  // "boundary"
Figures topologyFigures(const Tetrahedralization& made);  // "topology"
Figures latticeFigures(const Tetrahedralization& made);   // "lattice"
// "features". diagonal: of the solid, world units.
Figures featureFigures(const Tetrahedralization& made, double diagonal);
Figures featureFigures(const Hexahedralization& made);
Figures figures(const HexahedronCheck& check);
Figures figures(const Hexahedralization& made);        // "hexahedra"
Figures figures(const Polycube& cube);                 // "polycube"
Figures figures(const Remesh& made, double diagonal);  // "remesh"
Figures rowFigures(const CompareFem& made);            // of each method a value in each list
Figures figures(const CompareFem& made);               // "comparison": those, and what they say

// -- volumes (volume_figures.cc) --

Figures figures(const LevelSetCheck& check);        // "level_set"
Figures figures(const InverseStatistics& inverse);  // "inverse"
// "mass" and "densities", of one density: keys begin with its name.
Figures massFigures(const CarriedMass& mass);
Figures densityFigures(const CarriedMass& mass);
Figures figures(const ResamplingFigures& resampling);     // "resampling"
Figures figures(const DistanceTransfer& made);            // "distance"
Figures targetGridFigures(const DistanceTransfer& made);  // "grid", beside those of the source's
// "solve", "seams", "surface" of a texture continued into a solid.
Figures solveFigures(const SolidTexture& made);
Figures figures(const SeamFigures& seams);
Figures surfaceFigures(const SolidTexture& made);
Figures figures(const VolumeTextureResult& made);  // "texture"
Figures figures(const CarriedGeometry& carried);   // "geometry"
Figures figures(const ExrSliceResult& slices);     // "slices"
Figures figures(const SectionResult& section);     // "section"

// -- studies (study/study_figures.cc) --

// best, cheapest: what makes a run of these, as the user writes it; empty: there is none.
Figures studyFigures(const Study& study, const StudyFindings& findings, const std::string& best,
                     const std::string& cheapest);

}  // namespace innermap
