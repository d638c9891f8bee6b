#include "apps/report/words/flags.hpp"

#include "apps/report/words/summary.hpp"

namespace pivnp::report {

std::vector<std::string> flags(const Content& content) {
  std::vector<std::string> list = missed_limits(content);
  for (const RemarkWeight weight : {RemarkWeight::unusable, RemarkWeight::doubt})
    for (const Remark& remark : content.remarks)
      if (remark.weight == weight) list.push_back(remark.text);
  return list;
}

}  // namespace pivnp::report
