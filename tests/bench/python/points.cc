// points MAP POINTS COUNT THREADS: for points.py. Reads COUNT points, three doubles each, and the
// map; after each line on stdin carries them through it, with Jacobians where the line says so, and
// prints the seconds.
#include <chrono>
#include <ctime>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "innermap/core/run.h"
#include "innermap/fit/mapped_solid.h"

using namespace innermap;

int main(int argc, char** argv) try {
  if (argc != 5) throw std::runtime_error("usage: points MAP POINTS COUNT THREADS");
  const MappedSolid mapped = readMap(argv[1]);
  Points points(std::stoul(argv[3]));
  std::ifstream file(argv[2], std::ios::binary);
  file.read(reinterpret_cast<char*>(points.data()),
            static_cast<std::streamsize>(points.size() * sizeof(Vec3)));
  if (!file) throw std::runtime_error("cannot read the points");
  const ThreadLimit limit(std::stoi(argv[4]));
  for (std::string line; std::getline(std::cin, line);) {
    EvaluateFieldSettings settings;
    settings.accuracy = 1e-12 * mapped.boundary.target.diagonal;
    settings.gradients = line == "jacobian";
    const std::clock_t before = std::clock();
    const auto start = std::chrono::steady_clock::now();
    const double last = mapped.map.evaluate(points, settings).values(points.size() - 1, 0);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    std::cout << took.count() << ' ' << static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC
              << ' ' << last << std::endl;
  }
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
