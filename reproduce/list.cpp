#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {

const std::vector<Reproducible>& list() {
  static const std::vector<Reproducible> all = {
      p1_fig1(),  p1_fig2(),     p1_fig3(),  p1_fig4(),   p1_fig5(),   p1_table1(), p1_appendix(),
      p1_step(),  p1_truncate(), p2_fig2(),  p2_fig3(),   p2_fig4(),   p2_fig5(),   p2_fig6(),
      p2_fig7(),  p2_fig8(),     p2_fig9(),  p2_fig10(),  p2_fig11(),  p2_fig12(),  p2_fig13(),
      p2_fig14(), p2_fig15(),    p2_fig16(), p2_table1(), p2_table2(), p2_table3(),
  };
  return all;
}

}  // namespace twincell::reproduce
