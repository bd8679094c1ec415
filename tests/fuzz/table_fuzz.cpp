// Fuzz target: a table of comma-separated numbers.

#include "core/table.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  const fuzz::MemoryFile file(data, size);
  fuzz::accept_or_refuse([&] {
    const Table table = read_table(file.path());
    for (const auto& column : table.columns)
      if (column.size() != table.n_rows()) std::abort();
    for (const auto& name : table.names) (void)table.column(name);
  });
  return 0;
}
