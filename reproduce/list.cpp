#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {

const std::vector<Reproducible>& list() {
  static const std::vector<Reproducible> all = {
      p1_fig1(),  p1_fig2(),  p1_fig3(),   p1_fig4(),   p1_fig5(),   p1_table1(), p1_appendix(),
      p1_step(),  p2_fig2(),  p2_fig3(),   p2_fig4(),   p2_fig5(),   p2_fig6(),   p2_fig7(),
      p2_fig8(),  p2_fig9(),  p2_fig10(),  p2_fig11(),  p2_fig12(),  p2_fig13(),  p2_fig14(),
      p2_fig15(), p2_fig16(), p2_table1(), p2_table2(), p2_table3(),
  };
  return all;
}

std::string word_of(Verdict verdict) {
  return std::string(row_of(kVerdicts, verdict).word);
}

Verdict within(const sweep::Onset& onset, double low, double high) {
  if (onset.n == 0) return Verdict::absent;
  if (onset.value && *onset.value >= low && *onset.value <= high) return Verdict::pass;
  if ((onset.low && *onset.low > high) || (onset.high && *onset.high < low)) return Verdict::fail;
  return Verdict::inconclusive;
}

Verdict above(const sweep::Onset& upper, const sweep::Onset& lower) {
  if (upper.n == 0 || lower.n == 0) return Verdict::absent;
  if (evidence_above(upper, lower) >= sweep::kLikelihoodDrop) return Verdict::pass;
  if (evidence_above(lower, upper) >= sweep::kLikelihoodDrop) return Verdict::fail;
  return Verdict::inconclusive;
}

}  // namespace twincell::reproduce
