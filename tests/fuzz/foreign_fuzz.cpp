// Fuzz targets: trajectories of other programs, in two and in three dimensions. There is one program per
// format; TWINCELL_FUZZ_READER is its name.

#include <string_view>

#include "tests/fuzz/input.hpp"
#include "trajectory/foreign/foreign_trajectory.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  class Sink : public TrajectorySink {
   public:
    void append(const Frame&) override {}
  };
  constexpr std::string_view kReader = TWINCELL_FUZZ_READER;
  const ForeignFormat& format = foreign_format(kReader == "dump"    ? "lammps-dump"
                                               : kReader == "beads" ? "csv"
                                                                    : std::string(kReader),
                                               "");
  const fuzz::MemoryFile file(data, size);
  for (const int dimension : {2, 3})
    fuzz::accept_or_refuse([&] {
      ForeignOptions options;
      options.dimension = dimension;
      options.timestep = 0.001;
      options.bead_mass = 1;
      options.tracer_type = 2;
      Sink sink;
      ForeignTrajectory(file.path(), format, options).copy_to(sink);
    });
  return 0;
}
