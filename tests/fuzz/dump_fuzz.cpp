// Fuzz target: a LAMMPS dump, in two and in three dimensions.

#include "tests/fuzz/input.hpp"
#include "trajectory/formats/lammps_dump.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  class Sink : public TrajectorySink {
   public:
    void append(const Frame&) override {}
  };
  const fuzz::MemoryFile file(data, size);
  for (const int dimension : {2, 3})
    fuzz::accept_or_refuse([&] {
      LammpsDumpOptions options;
      options.dimension = dimension;
      options.timestep = 0.001;
      options.bead_mass = 1;
      Sink sink;
      LammpsDump(file.path(), options).copy_to(sink);
    });
  return 0;
}
