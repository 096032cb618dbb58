#include <gtest/gtest.h>

#include <regex>

#include "innermap/fit/mapped_solid.h"

namespace innermap {
namespace {

DeterminantFigures figures(std::size_t checked, std::size_t folded, double least) {
  return {.checked = checked, .folded = folded, .least = least};
}

// All that can be known, and nothing that speaks against the map.
Injectivity sound() {
  Injectivity known{.inside = figures(20000, 0, 0.25),
                    .boundary = figures(10000, 0, 0.125),
                    .voxels = figures(5000, 0, 0.5)};
  static_cast<DeterminantFigures&>(known.cells) = figures(24000, 0, 0.75);
  known.cells.share = 0.9;
  known.cells.overlaps = 0;
  known.degree = {1500, 1, 1};
  known.boundaryError = 0.003;
  return known;
}

bool says(const Injectivity& known, const std::string& what) {
  return injectivityStatement(known).find(what) != std::string::npos;
}

constexpr const char* kNot = "So the map is not one-to-one";
constexpr const char* kThen = "Then exactly one point goes to each";
constexpr const char* kUnproved = "is not proven";
constexpr const char* kWhole = "is one-to-one as a whole";
constexpr const char* kNoMap = "No continuous map";

TEST(Injectivity, SaysWhatWasCheckedAndWhatFollows) {
  const Injectivity known = sound();
  EXPECT_FALSE(notOneToOne(known));
  for (const char* what :
       {"det J > 0 at all 20000 points inside (least 0.25), all 10000 points of the boundary "
        "(least "
        "0.125), all 5000 voxels (least 0.5) and all 24000 cells between voxels (least 0.75).",
        "within 0.003 of the target's diagonal", "winds once about the 1500 points", "(degree 1)",
        "Neither surface runs through itself.", kThen, kUnproved, kWhole})
    EXPECT_TRUE(says(known, what)) << what << "\n" << injectivityStatement(known);
  EXPECT_FALSE(says(known, kNot));
  EXPECT_EQ(injectivityLine(known),
            "one-to-one as far as checked; no fold at 20000 points inside, 10000 points of the "
            "boundary, 5000 voxels and 24000 cells between voxels");
}

TEST(Injectivity, SaysNothingOfWhatWasNotChecked) {
  EXPECT_EQ(injectivityStatement({}),
            "No points inside were checked. Neither surface runs through itself. It is not known "
            "whether the map is one-to-one.");
  EXPECT_EQ(injectivityLine({}), "one-to-one: not checked");
  EXPECT_TRUE(injectivityFacts({}).empty());
  Injectivity grid{.voxels = figures(5000, 0, 0.5)};
  EXPECT_TRUE(says(grid, "none proves it"));
  EXPECT_FALSE(says(grid, "points inside"));
  EXPECT_FALSE(says(grid, "winds"));
  EXPECT_FALSE(says(grid, kThen));
  EXPECT_FALSE(says(grid, kWhole));
}

TEST(Injectivity, AFoldIsSaidWithItsShareAndItsCause) {
  Injectivity known = sound();
  known.inside = figures(20000, 50, -0.5);
  EXPECT_TRUE(notOneToOne(known));
  EXPECT_TRUE(
      says(known, "det J is not above 0 at 50 of 20000 points inside (0.25%, least -0.5)."));
  EXPECT_TRUE(says(known, kNot));
  known.inside.foldedAtOverlap = 20;
  EXPECT_TRUE(says(known, "least -0.5; 20 where the target runs through itself)"));
  known.inside.foldedAtOverlap = 50;
  EXPECT_TRUE(says(known, "least -0.5; all where the target runs through itself)"));
  EXPECT_EQ(injectivityLine(known).substr(0, 55),
            "not one-to-one; folded: 50 of 20000 points inside; no f");
}

// Folded cells are those of another map, the one that is linear on them.
TEST(Injectivity, FoldedCellsAreNotFoldsOfTheMap) {
  Injectivity known = sound();
  known.cells.folded = 3;
  EXPECT_FALSE(notOneToOne(known));
  EXPECT_TRUE(says(known, "det J is not above 0 at 3 of 24000 cells"));
  EXPECT_FALSE(says(known, kWhole));
  known.cells.folded = 0;
  known.cells.overlaps = 2;
  EXPECT_TRUE(says(known, "their images overlap at 2 places of their boundary."));
  EXPECT_FALSE(says(known, kWhole));
  known.cells.overlaps = -1;
  EXPECT_FALSE(says(known, "The map that is linear"));
}

TEST(Injectivity, ABoundaryThatWindsTwiceIsNotThatOfAOneToOneMap) {
  Injectivity known = sound();
  known.degree = {1500, 1, 2};
  EXPECT_TRUE(notOneToOne(known));
  EXPECT_TRUE(says(known, "winds 1 to 2 times about the 1500 points"));
  EXPECT_TRUE(says(known, "its boundary winds up to 2 times about a point."));
  EXPECT_FALSE(says(known, kThen));
  known.degree = {1500, -1, 1};
  EXPECT_TRUE(notOneToOne(known));
  EXPECT_TRUE(says(known, "its boundary winds -1 time about a point"));
  known.degree = {1500, 0, 1};
  EXPECT_FALSE(notOneToOne(known));
  EXPECT_FALSE(says(known, kThen));
  known.degree = {};
  EXPECT_TRUE(says(known, "its degree is not known"));
}

TEST(Injectivity, TargetsThatRunThroughThemselves) {
  Injectivity known = sound();
  known.target = {65, {{1, 2, 3}}};
  EXPECT_TRUE(says(
      known, "The target runs through itself: 65 pairs of triangles, the first near (1, 2, 3)."));
  EXPECT_TRUE(says(known, kNoMap));
  EXPECT_FALSE(notOneToOne(known));  // this one meets the target only within its error
  // Parts of the source that overlap are one solid, whose target nobody told of.
  known.source = {1, {}};
  EXPECT_TRUE(says(known, "The source runs through itself: 1 pair of triangles."));
  EXPECT_TRUE(says(known, "mapped as one solid"));
  EXPECT_FALSE(says(known, kNoMap));
}

TEST(Injectivity, AMirrorIsNoFold) {
  Injectivity known = sound();
  known.mirrored = true;
  EXPECT_FALSE(notOneToOne(known));
  EXPECT_TRUE(says(known, "mirrors"));
  EXPECT_TRUE(says(known, "det J < 0 at all 20000 points inside"));
  EXPECT_FALSE(says(known, kThen));
  EXPECT_EQ(injectivityLine(known).find("folded:"), std::string::npos);
}

TEST(Injectivity, AMirrorFoldsWhereItDoesNotTurnOver) {
  Injectivity known = sound();
  known.mirrored = true;
  known.inside = figures(20000, 4, -0.5);
  EXPECT_TRUE(notOneToOne(known));
  EXPECT_TRUE(
      says(known, "det J is not below 0 at 4 of 20000 points inside (0.02%, greatest 0.5)"));
  EXPECT_NE(injectivityLine(known).find("folded: 4 of 20000 points inside"), std::string::npos);
}

// Whatever is known: never "not" without a reason, never what follows from determinants that are
// all above 0 where one is not, never "as a whole" of cells that are not.
TEST(Injectivity, NoCombinationSaysMoreThanItsFigures) {
  for (int bits = 0; bits < 1024; ++bits) {
    const auto bit = [bits](int k) { return (bits >> k & 1) != 0; };
    Injectivity known = sound();
    if (bit(0)) known.inside = {};
    if (bit(1)) known.inside = figures(20000, 7, -1);
    if (bit(2)) known.boundary = figures(10000, 9, -1);
    if (bit(3)) known.voxels = {};
    if (bit(4)) known.voxels = figures(5000, 1, -1);
    if (bit(5)) known.cells.folded = 2;
    if (bit(6)) known.cells.overlaps = 1;
    if (bit(7)) known.degree = {1500, bit(8) ? -1 : 1, bit(8) ? 1 : 2};
    if (bit(8) && !bit(7)) known.degree = {};
    if (bit(9)) known.target = {3, {{0, 0, 0}}};
    const bool fold = bit(1) || bit(2) || bit(4);
    const std::string text = injectivityStatement(known);
    SCOPED_TRACE(text);
    EXPECT_EQ(notOneToOne(known), fold || bit(7));
    EXPECT_EQ(says(known, kNot), fold || bit(7));
    EXPECT_EQ(says(known, kWhole), !bit(5) && !bit(6));
    EXPECT_EQ(says(known, kNoMap), bit(9));
    const bool checked = known.inside.checked > 0 || known.voxels.checked > 0;
    EXPECT_EQ(says(known, kThen), !fold && !bit(7) && !bit(8) && checked);
    EXPECT_EQ(says(known, kThen), says(known, kUnproved));
    EXPECT_EQ(says(known, "7 of 20000 points inside"), bit(1));
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_FALSE(std::regex_search(text, std::regex("  |\\.\\.| $|^ ")));
  }
}

TEST(Injectivity, DeterminantsAreCounted) {
  DeterminantFigures out;
  out.add(2);
  out.add(0);
  out.add(-1, true);
  out.add(3);
  EXPECT_EQ(out.checked, 4u);
  EXPECT_EQ(out.folded, 2u);
  EXPECT_EQ(out.foldedAtOverlap, 1u);
  EXPECT_EQ(out.least, -1);
  DeterminantFigures sum;
  sum.add(DeterminantFigures{});
  EXPECT_EQ(sum.checked, 0u);
  sum.add(figures(10, 1, 5));
  sum.add(out);
  EXPECT_EQ(sum.checked, 14u);
  EXPECT_EQ(sum.folded, 3u);
  EXPECT_EQ(sum.foldedAtOverlap, 1u);
  EXPECT_EQ(sum.least, -1);
}

ProofFigures proven() {
  return {.cells = 5000, .proven = 1, .least = 0.01, .boundaryError = 0.004};
}

TEST(Injectivity, AProofSaysWhatFollowsAndTakesThePlaceOfWhatPointsSuggest) {
  Injectivity known = sound();
  known.proof = proven();
  EXPECT_FALSE(notOneToOne(known));
  EXPECT_TRUE(says(known, "Proven: det J > 0 everywhere in the solid, on 5000 cells"));
  EXPECT_TRUE(
      says(known,
           "each point farther than 0.004 of the target's diagonal from the target's surface "
           "has as many preimages as that surface winds about it: one inside, none outside"));
  EXPECT_FALSE(says(known, kUnproved));
  EXPECT_FALSE(says(known, kThen));
  EXPECT_EQ(injectivityLine(known).substr(0, 39), "one-to-one, proven deeper than 0.004; n");
  known.source.pairs = 3;  // the boundary's values jump where parts cross
  EXPECT_FALSE(says(known, "as many"));
  EXPECT_EQ(injectivityLine(known).substr(0, 23), "nowhere folded, proven;");
}

TEST(Injectivity, AProofOfTheWholeIsSaidAndSoIsItsFailure) {
  Injectivity known = sound();
  known.proof = proven();
  known.proof.oneToOne = 1;
  EXPECT_TRUE(says(known, "No two points of the solid go to one: it is mapped one-to-one"));
  EXPECT_EQ(injectivityLine(known).substr(0, 19), "one-to-one, proven;");
  known.proof.oneToOne = 0;
  EXPECT_TRUE(says(known, "It is not decided whether two points of the solid go to one."));
  EXPECT_EQ(injectivityLine(known).substr(0, 32), "one-to-one, proven deeper than 0");
}

TEST(Injectivity, CellsThatAreUndecidedOrFoldedAreNoProof) {
  Injectivity known = sound();
  known.proof = proven();
  known.proof.undecided = 7;
  known.proof.undecidedShare = 0.001;
  EXPECT_FALSE(notOneToOne(known));
  EXPECT_FALSE(known.proof.whole());
  EXPECT_TRUE(says(known, "On 7 cells, 0.1% of the solid at most, it is undecided."));
  EXPECT_TRUE(says(known, "surface, and outside the images of undecided and turned-over cells,"));
  known.proof.negative = 2;
  EXPECT_TRUE(notOneToOne(known));
  EXPECT_TRUE(says(known, kNot));
}

TEST(Injectivity, AMissingBoundIsNamed) {
  Injectivity known = sound();
  known.proof = proven();
  const char* const kMissing = "It is not decided how far the boundary is off at most.";
  EXPECT_FALSE(says(known, kMissing));
  known.proof.boundaryError = 0;
  EXPECT_TRUE(says(known, kMissing));
}

// Whatever a bound is, the sentence holds.
TEST(Injectivity, BoundsAreRoundedToTheSideOnWhichTheyHold) {
  Injectivity known = sound();
  known.proof = proven();
  known.proof.least = 0.0199996;
  known.proof.boundaryError = 0.010501;
  EXPECT_TRUE(says(known, "(size 0.0199 at least)"));
  EXPECT_TRUE(says(known, "is farther than 0.0106 of"));
  EXPECT_TRUE(says(known, "each point farther than 0.0106 of"));
  EXPECT_NE(injectivityLine(known).find("deeper than 0.0106;"), std::string::npos);
  known.proof.undecided = 1;
  known.proof.undecidedShare = 1.01e-9;
  known.proof.proven = 1 - 1e-9;
  EXPECT_TRUE(says(known, "det J > 0 in 99.9999% of the solid at least"));
  EXPECT_TRUE(says(known, "On 1 cell, 1.1e-07% of the solid at most"));
}

// Two balls, one of which is mirrored, may be mapped one-to-one.
TEST(Injectivity, OfSeveralPartsEachMayBeTurnedOver) {
  Injectivity known = sound();
  known.solid = {2, 2, 0, false};
  known.inside = figures(20000, 9000, -0.5);
  known.degree = {1500, -1, 1};
  EXPECT_FALSE(notOneToOne(known));
  EXPECT_FALSE(says(known, kNot));
  EXPECT_TRUE(says(known, "on a part that is turned over only in places"));
  EXPECT_EQ(injectivityLine(known).substr(0, 22), "turned over in places;");
  known.proof = proven();
  known.proof.negative = 100;
  EXPECT_FALSE(says(known, kNot));
  known.degree = {1500, 1, 2};  // two parts, in one place
  EXPECT_TRUE(says(known, kNot));
  known.solid.parts = 1;  // a cavity has a surface, too
  known.degree = {1500, 1, 1};
  EXPECT_TRUE(notOneToOne(known));
}

TEST(Injectivity, WhatIsTurnedOverAllThroughAndADeterminantOfZeroRuleNothingOut) {
  Injectivity known = sound();
  known.inside = figures(20000, 20000, -0.5);
  known.boundary = figures(10000, 10000, -0.5);
  known.voxels = {};
  EXPECT_FALSE(says(known, kNot));
  EXPECT_FALSE(says(known, kThen));
  known = sound();
  known.inside = figures(20000, 3, 0);
  EXPECT_TRUE(says(known, "det J is not above 0 at 3 of 20000 points inside"));
  EXPECT_FALSE(notOneToOne(known));
  EXPECT_FALSE(says(known, kThen));
}

// How often the target's surface winds about a point is known of one that does not cross itself,
// and of no more than one.
TEST(Injectivity, ThatOnePointGoesToEachIsSaidOfSurfacesThatWindOnce) {
  const auto saysOne = [](const Injectivity& known) {
    const bool line = injectivityLine(known).find("one-to-one, proven deeper") == 0;
    EXPECT_EQ(line, says(known, "one inside, none outside"));
    EXPECT_TRUE(says(known, "has as many preimages as that surface winds about it"));
    return line;
  };
  Injectivity known = sound();
  known.proof = proven();
  EXPECT_TRUE(saysOne(known));
  known.solid = {2, 2, 0, false};  // one ball may lie in the other
  EXPECT_FALSE(saysOne(known));
  known.solid = {1, 2, 0, false};
  EXPECT_FALSE(saysOne(known));
  known.solid = {1, 1, 3, false};  // caps may cross
  EXPECT_FALSE(saysOne(known));
  EXPECT_TRUE(says(known, "Neither surface runs through itself; the caps"));
  known.solid = {};
  known.target = {1, {{0, 0, 0}}};
  EXPECT_FALSE(saysOne(known));
  known.target = {};
  known.solid.overlaps = true;
  EXPECT_FALSE(says(known, "as many preimages"));
}

TEST(Injectivity, FactsGiveTheFiguresBack) {
  Injectivity known = sound();
  known.proof = proven();
  known.proof.mirrored = true;
  known.proof.undecided = 3;
  known.proof.oneToOne = 0;
  known.inside.folded = 3;
  known.inside.foldedAtOverlap = 2;
  known.inside.least = -0.1;
  known.outside = 0.0123456789012345678;
  known.repaired = 4;
  known.degree = {1500, -1, 2};
  Injectivity again;
  readInjectivity(injectivityFacts(known), again);
  EXPECT_EQ(injectivityFacts(again), injectivityFacts(known));
  EXPECT_EQ(injectivityStatement(again), injectivityStatement(known));
  for (const auto& [key, value] : injectivityFacts(known))
    EXPECT_EQ(key.substr(0, 11), "one_to_one_");
}

TEST(Injectivity, OfManyCrossingsTheFirstArePlaced) {
  MeshReport check{.selfIntersections = 500};
  for (int i = 0; i < 100; ++i) check.crossings.push_back({i, i + 1, {double(i), 0, 0}});
  const SelfIntersectionFigures out = selfIntersectionFigures(check);
  EXPECT_EQ(out.pairs, 500u);
  ASSERT_EQ(out.places.size(), 16u);
  EXPECT_EQ(out.places[15].x, 15);
}

}  // namespace
}  // namespace innermap
