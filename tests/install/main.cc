// Fits a map with the installed library and writes its grids.
#include <cstdio>

#include "innermap/innermap.h"

int main(int argc, char** argv) try {
  if (argc != 4) return 2;
  const innermap::Mesh source = innermap::readMesh(argv[1]);
  const innermap::MapFit fit = innermap::fitMap(source, innermap::readMeshLike(argv[2], source));
  std::printf("boundary error: rms %.2g, 99%% %.2g, largest %.2g of the diagonal\n", fit.error.rms,
              fit.error.p99, fit.error.max);
  innermap::writeVdb(argv[3], innermap::evaluateOnGrid(fit).all());
  return fit.tolerance->met ? 0 : 1;
} catch (const innermap::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
