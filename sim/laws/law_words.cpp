#include "sim/laws/law_words.hpp"

#include <algorithm>
#include <iterator>
#include <variant>

#include "core/choice.hpp"
#include "sim/laws/axes.hpp"

namespace twincell::sim {

namespace {

/// Calls visit(Law{}) for every law of an axis.
template <class Visit, class... Laws>
void for_each_law(const std::variant<Laws...>&, Visit visit) {
  (visit(Laws{}), ...);
}

template <class Axis>
std::vector<std::string> words() {
  std::vector<std::string> all;
  for_each_law(Axis{}, [&](const auto& law) { all.emplace_back(law.kWord); });
  return all;
}

template <class Axis>
std::string help() {
  std::vector<Choice<std::monostate>> rows;
  for_each_law(Axis{}, [&](const auto& law) { rows.push_back({{}, law.kWord, law.kHelp}); });
  return help_of(rows);
}

}  // namespace

std::vector<std::string> normal_words() {
  return words<NormalAxis>();
}
std::vector<std::string> tangential_words() {
  return words<TangentialAxis>();
}
std::vector<std::string> rolling_words() {
  return words<RollingAxis>();
}
std::string normal_help() {
  return help<NormalAxis>();
}
std::string tangential_help() {
  return help<TangentialAxis>();
}
std::string rolling_help() {
  return help<RollingAxis>();
}
bool has_history(const std::string& tangential) {
  bool history = false;
  for_each_law(TangentialAxis{},
               [&](const auto& law) { history = history || (law.kHistory && tangential == law.kWord); });
  return history;
}

bool tangential_reads(const std::string& tangential, const std::string& key) {
  const std::vector<std::string> readers = readers_of(key).laws;
  return std::find(readers.begin(), readers.end(), tangential) != readers.end();
}

std::string law_without_history(const std::string& tangential) {
  std::string word = tangential;
  for_each_law(TangentialAxis{}, [&]<class Law>(const Law&) {
    if constexpr (Law::kHistory)
      if (tangential == Law::kWord) word = Law::kWithoutHistory;
  });
  return word;
}

void check_laws(const std::string& normal, const std::string& tangential, const std::string& rolling,
                const ContactTable& table) {
  static_cast<void>(read_law<NormalAxis>(normal, table));
  static_cast<void>(read_law<TangentialAxis>(tangential, table));
  static_cast<void>(read_law<RollingAxis>(rolling, table));
}

std::vector<std::string> keys_of(const std::string& normal, const std::string& tangential,
                                 const std::string& rolling) {
  std::vector<std::string> keys;
  const auto collect = [&](const std::string& word) {
    return [&](const auto& law) {
      if (word.empty() || word == law.kWord)
        keys.insert(keys.end(), std::begin(law.kKeys), std::end(law.kKeys));
    };
  };
  for_each_law(NormalAxis{}, collect(normal));
  for_each_law(TangentialAxis{}, collect(tangential));
  for_each_law(RollingAxis{}, collect(rolling));
  return keys;
}

std::vector<std::string> all_law_keys() {
  return keys_of("", "", "");
}

KeyReaders readers_of(const std::string& key) {
  KeyReaders readers;
  const auto collect = [&](const char* axis) {
    return [&readers, &key, axis](const auto& law) {
      if (std::find(std::begin(law.kKeys), std::end(law.kKeys), key) == std::end(law.kKeys)) return;
      if (readers.axis.empty()) readers.axis = axis;
      readers.laws.emplace_back(law.kWord);
    };
  };
  for_each_law(NormalAxis{}, collect("normal"));
  for_each_law(TangentialAxis{}, collect("tangential"));
  for_each_law(RollingAxis{}, collect("rolling"));
  return readers;
}

}  // namespace twincell::sim
