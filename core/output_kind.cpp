#include "core/output_kind.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "core/hdf5.hpp"
#include "core/hdf5_open.hpp"

namespace twincell {

namespace {

std::string head_of(const std::filesystem::path& file, std::size_t bytes) {
  std::ifstream stream(file, std::ios::binary);
  std::string head(bytes, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(bytes));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return head;
}

/// Whether the file opens as HDF5 and satisfies `says`.
template <class Says>
bool hdf5_says(const std::filesystem::path& file, Says says) {
  if (head_of(file, 8) != "\x89HDF\r\n\x1a\n") return false;
  try {
    const h5::Handle handle = h5::open_file(file);
    return handle && says(handle.get());
  } catch (const std::exception&) {
    return false;
  }
}

bool made_by_twincell(hid_t file) {
  if (H5Lexists(file, "h5md", H5P_DEFAULT) <= 0 || H5Lexists(file, "h5md/creator", H5P_DEFAULT) <= 0)
    return false;
  const h5::Handle creator = h5::own(H5Gopen2(file, "h5md/creator", H5P_DEFAULT), "creator");
  return H5Aexists(creator.get(), "name") > 0 &&
         h5::read_text_attribute(creator.get(), "name") == std::vector<std::string>{"twincell"};
}

/// Whether a trajectory states that its run failed.
bool is_of_failed_run(hid_t file) {
  if (H5Lexists(file, "twincell", H5P_DEFAULT) <= 0) return false;
  const h5::Handle ours = h5::own(H5Oopen(file, "twincell", H5P_DEFAULT), "twincell");
  return H5Aexists(ours.get(), "failed") > 0;
}

/// Whether a trajectory is of beads that another program located or simulated. Those of `simulate` state
/// their scene, those of `track` how the beads were tracked.
bool is_imported(hid_t file) {
  std::string text;
  if (h5::exists(file, "twincell/tracking") || !h5::exists(file, "parameters/provenance") ||
      !h5::read_text(file, "parameters/provenance", text))
    return false;
  const auto provenance = nlohmann::json::parse(text, nullptr, false);
  return provenance.is_object() && !provenance.contains("config");
}

/// Whether a trajectory states this source, or none. \param source empty: any
bool is_of_source(hid_t file, const std::string& source) {
  if (source.empty() || H5Lexists(file, "twincell", H5P_DEFAULT) <= 0) return true;
  const h5::Handle ours = h5::own(H5Oopen(file, "twincell", H5P_DEFAULT), "twincell");
  const std::vector<std::string> stated = h5::read_text_attribute(ours.get(), "source");
  return stated.empty() || stated.front() == source;
}

}  // namespace

Product Product::trajectory(const std::string& source) {
  return {.name = source == "simulation"   ? "a trajectory of a simulation"
                  : source == "experiment" ? "a trajectory of an experiment"
                                           : "a trajectory",
          .sign = Sign::h5md_creator,
          .mark = source};
}

Product Product::table(const std::string& heading) {
  return {.name = "a table with these columns",
          .sign = Sign::first_line,
          .mark = heading.substr(0, heading.find('\n'))};
}

bool is_product(const std::filesystem::path& file, const Product& product) {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(file, ec)) return false;  // to read a pipe is to wait
  switch (product.sign) {
    case Product::Sign::none:
      return false;
    case Product::Sign::h5md_creator:
      return hdf5_says(file,
                       [&](hid_t id) { return made_by_twincell(id) && is_of_source(id, product.mark); });
    case Product::Sign::imported:
      return hdf5_says(file, [](hid_t id) { return made_by_twincell(id) && is_imported(id); });
    case Product::Sign::failed_run:
      return hdf5_says(file, [](hid_t id) { return made_by_twincell(id) && is_of_failed_run(id); });
    case Product::Sign::results_group:
      return hdf5_says(file, [](hid_t id) {
        return H5Lexists(id, "results", H5P_DEFAULT) > 0 && H5Lexists(id, "provenance", H5P_DEFAULT) > 0;
      });
    case Product::Sign::checkpoint:
      return hdf5_says(file, [](hid_t id) { return H5Aexists(id, "sha256") > 0; });
    case Product::Sign::first_line: {
      const std::string head = head_of(file, product.mark.size() + 1);
      return head == product.mark + "\n" || head == product.mark + "\r";
    }
    case Product::Sign::headings: {
      const std::string head = head_of(file, 4096);
      const std::size_t end = head.find_first_of("\r\n");
      if (end == std::string::npos) return false;
      std::istringstream marks(product.mark);
      for (std::string mark; std::getline(marks, mark);)
        if (head.compare(0, end, mark) == 0) return true;
      return false;
    }
    case Product::Sign::beginning:
      return head_of(file, product.mark.size()) == product.mark;
    case Product::Sign::head: {
      const std::string head = head_of(file, 4096);
      std::istringstream marks(product.mark);
      for (std::string mark; std::getline(marks, mark);)
        if (head.find(mark) != std::string::npos) return true;
      return false;
    }
    case Product::Sign::ending: {
      std::ifstream stream(file, std::ios::binary);
      stream.seekg(-static_cast<std::streamoff>(product.mark.size()), std::ios::end);
      std::string tail(product.mark.size(), '\0');
      return stream.read(tail.data(), static_cast<std::streamsize>(tail.size())) && tail == product.mark;
    }
    case Product::Sign::json_member: {
      std::ifstream stream(file, std::ios::binary);
      const auto document = nlohmann::json::parse(stream, nullptr, false);
      return document.is_object() && document.contains(product.mark);
    }
    case Product::Sign::picture_software: {
      // IHDR ends at byte 33; the text chunk follows it.
      const std::string head = head_of(file, 64);
      return head.substr(0, 4) == "\x89PNG" &&
             head.find(std::string("tEXtSoftware\0twincell", 21)) == std::size_t{37};
    }
  }
  return false;
}

}  // namespace twincell
