#include "pivnp/image/files/frame_order.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "pivnp/image/files/frame_files.hpp"

namespace pivnp::image {

namespace fs = std::filesystem;

namespace {

bool digit(char c) { return c >= '0' && c <= '9'; }

std::size_t end_of_digits(std::string_view s, std::size_t at) {
  while (at < s.size() && digit(s[at])) ++at;
  return at;
}

struct Number {
  std::size_t begin = 0, end = 0;    // in the name; from the minus sign, if that counts
  bool minus = false, open = false;  // open: the sign stands behind no letter or digit
  std::string whole, decimals;       // as written; no decimals: a whole number
  std::string fraction;              // the decimals without closing zeros, where they count
};

struct Name {
  std::string text;
  std::vector<Number> numbers;
  std::string pattern;  // the text between the numbers, the ending in small letters
};

// Without leading ones.
std::string_view without_zeros(std::string_view digits) {
  const std::size_t first = std::min(digits.find_first_not_of('0'), digits.size() - 1);
  return digits.substr(first);
}

// Numbers as they are written if every sign and every decimal point counts.
Name taken_apart(const std::string& text) {
  Name name{text, {}, {}};
  const std::string_view s = text;
  const std::size_t ending = std::min(s.rfind('.'), s.size());
  for (std::size_t at = 0; at < s.size();) {
    if (!digit(s[at])) {
      name.pattern += at > ending ? char(std::tolower(static_cast<unsigned char>(s[at]))) : s[at];
      ++at;
      continue;
    }
    Number n;
    n.begin = at, n.end = end_of_digits(s, at);
    n.whole = s.substr(at, n.end - at);
    const bool point = n.end + 1 < s.size() && (s[n.end] == '.' || s[n.end] == ',') && digit(s[n.end + 1]);
    const std::size_t after = point ? end_of_digits(s, n.end + 1) : n.end;
    const bool more = after + 1 < s.size() && s[after] == s[n.end] && digit(s[after + 1]);  // a date, a version
    const bool within = at > 1 && (s[at - 1] == '.' || s[at - 1] == ',') && digit(s[at - 2]);
    if (point && !more && !within) {
      n.decimals = s.substr(n.end + 1, after - n.end - 1);
      n.end = after;
    }
    const std::size_t before = at > 0 && s[at - 1] == '-' ? at - 1 : at;
    if (before < at && (before == 0 || !digit(s[before - 1]))) {
      n.minus = true, n.begin = before;
      n.open = before == 0 || !std::isalnum(static_cast<unsigned char>(s[before - 1]));
      name.pattern.pop_back();
    }
    name.pattern += '#';
    name.numbers.push_back(n);
    at = n.end;
  }
  return name;
}

// Whether the second numbers are those of a count: none like 05 that only a fraction has, and some like 10, or one
// after the other.
bool counts(const std::vector<std::pair<std::string, std::string>>& parts) {
  bool round = false, next = true, several = false;
  std::map<std::string, std::vector<long>> groups;
  for (const auto& [whole, decimals] : parts) {
    if (decimals.empty() || decimals.size() > 9) return false;
    if (decimals.size() > 1 && decimals.front() == '0') return false;
    round = round || (decimals.size() > 1 && decimals.back() == '0');
    groups[std::string(without_zeros(whole))].push_back(std::stol(decimals));
  }
  for (auto& [whole, values] : groups) {
    std::sort(values.begin(), values.end());
    several = several || values.size() > 1;
    for (std::size_t k = 1; k < values.size(); ++k) next = next && values[k] == values[k - 1] + 1;
  }
  return round || (several && next);
}

// Of the names of one pattern: which signs and points count.
void settle(std::vector<Name*>& names) {
  for (std::size_t p = 0; p < names.front()->numbers.size(); ++p) {
    std::size_t minus = 0, open = 0;
    std::set<std::size_t> lengths;
    std::vector<std::pair<std::string, std::string>> parts;
    for (const Name* name : names) {
      const Number& n = name->numbers[p];
      minus += n.minus, open += n.open;
      lengths.insert(n.decimals.size());
      parts.emplace_back(n.whole, n.decimals);
    }
    const bool sign = minus < names.size() || open == names.size(), fraction = lengths.size() == 1 || !counts(parts);
    for (Name* name : names) {
      Number& n = name->numbers[p];
      if (n.minus && !sign) n.minus = false, ++n.begin;
      n.fraction = n.decimals.substr(0, n.decimals.find_last_not_of('0') + 1);
      if (fraction) continue;
      Number second{n.end - n.decimals.size(), n.end, false, false, n.decimals, "", ""};
      n.end = second.begin - 1, n.decimals = n.fraction = "";
      name->numbers.insert(name->numbers.begin() + std::ptrdiff_t(p) + 1, std::move(second));
    }
    if (!fraction) ++p;
  }
}

int compared(std::string_view a, std::string_view b) { return a < b ? -1 : a > b ? 1 : 0; }

int compared(const Number& a, const Number& b) {
  const std::string_view x = without_zeros(a.whole), y = without_zeros(b.whole);
  const auto zero = [](const Number& n) { return without_zeros(n.whole) == "0" && n.fraction.empty(); };
  const bool below_a = a.minus && !zero(a), below_b = b.minus && !zero(b);
  if (below_a != below_b) return below_a ? -1 : 1;
  int size = x.size() != y.size() ? (x.size() < y.size() ? -1 : 1) : compared(x, y);
  if (size == 0) size = compared(a.fraction, b.fraction);
  return below_a ? -size : size;
}

const Number* number_at(const Name& name, std::size_t at) {
  for (const Number& n : name.numbers)
    if (n.begin == at) return &n;
  return nullptr;
}

bool earlier(const Name& a, const Name& b) {
  std::size_t i = 0, j = 0;
  while (i < a.text.size() && j < b.text.size()) {
    const Number *x = number_at(a, i), *y = number_at(b, j);
    if (x && y) {
      if (const int c = compared(*x, *y); c != 0) return c < 0;
      i = x->end, j = y->end;
    } else if (a.text[i] != b.text[j]) {
      return static_cast<unsigned char>(a.text[i]) < static_cast<unsigned char>(b.text[j]);
    } else {
      ++i, ++j;
    }
  }
  const std::string_view rest_a = std::string_view(a.text).substr(i), rest_b = std::string_view(b.text).substr(j);
  return rest_a != rest_b ? natural_less(rest_a, rest_b) : natural_less(a.text, b.text);
}

// The numbers that count the files as whole ones of equal unit; nothing where several numbers change or are too long.
std::optional<std::vector<std::int64_t>> counters(const std::vector<const Name*>& names) {
  constexpr std::size_t most_digits = 17;
  std::optional<std::size_t> place;
  for (const Name* name : names) {
    if (name->pattern != names.front()->pattern || name->numbers.size() != names.front()->numbers.size()) return {};
    for (std::size_t p = 0; p < name->numbers.size(); ++p) {
      if (compared(name->numbers[p], names.front()->numbers[p]) == 0) continue;
      if (place && *place != p) return {};
      place = p;
    }
  }
  if (!place) return {};
  std::size_t decimals = 0;
  for (const Name* name : names) decimals = std::max(decimals, name->numbers[*place].fraction.size());
  std::vector<std::int64_t> values;
  for (const Name* name : names) {
    const Number& n = name->numbers[*place];
    std::string digits = std::string(without_zeros(n.whole)) + n.fraction;
    digits.append(decimals - n.fraction.size(), '0');
    if (digits.size() > most_digits) return {};
    values.push_back((n.minus ? -1 : 1) * std::stoll(digits));
  }
  return values;
}

// From 59 to 00 of the next minute or hour: a time of day, which skips without a frame that is missing.
bool turns_over(std::int64_t from, std::int64_t step, std::int64_t usual) {
  const std::int64_t minute = 40 + usual, hour = 4040 + usual;
  return from >= 0 && from % 100 + usual >= 60 && (step == minute || step == hour);
}

void keep_gaps(const std::vector<const Name*>& names, TimeOrder& order) {
  const auto values = counters(names);
  if (!values || values->size() < 3) return;
  std::vector<std::int64_t> steps;
  for (std::size_t k = 1; k < values->size(); ++k) steps.push_back((*values)[k] - (*values)[k - 1]);
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  const std::int64_t usual = *least;
  if (usual <= 0 || usual == *most) return;
  const auto as_usual = std::count(steps.begin(), steps.end(), usual);
  bool even = 2 * as_usual > std::ptrdiff_t(steps.size());
  for (std::size_t k = 0; k < steps.size(); ++k)
    even = even && steps[k] % usual == 0 && !turns_over((*values)[k], steps[k], usual);
  if (!even) {
    order.remarks.push_back({"The numbers in the names of the frames do not step evenly (" + names.front()->text + " ... " +
                            names.back()->text + "): the frames are taken as evenly spaced in time.",
                             RemarkWeight::doubt});
    return;
  }
  for (std::size_t k = 0; k < values->size(); ++k) order.clock[k] = double((*values)[k] - values->front()) / double(usual);
  const std::size_t first = std::size_t(std::find_if(steps.begin(), steps.end(), [&](auto s) { return s != usual; }) - steps.begin());
  const std::size_t gaps = steps.size() - std::size_t(as_usual);
  order.remarks.push_back({"The numbers in the names of the frames skip " +
                          (gaps == 1 ? std::string("once") : std::to_string(gaps) + " times, first") + " between " +
                          names[first]->text + " and " + names[first + 1]->text +
                          ": the time of the missing frames is kept."});
}

}  // namespace

TimeOrder in_time_order(std::vector<fs::path> files) {
  std::vector<Name> names;
  names.reserve(files.size());
  for (const fs::path& file : files) names.push_back(taken_apart(file.filename().string()));
  std::map<std::string, std::vector<Name*>> patterns;
  for (Name& name : names) patterns[name.pattern].push_back(&name);
  for (auto& [pattern, same] : patterns) settle(same);

  std::vector<std::size_t> natural(files.size());
  for (std::size_t k = 0; k < natural.size(); ++k) natural[k] = k;
  const auto by_folder = [&](std::size_t a, std::size_t b) {
    const fs::path x = files[a].parent_path(), y = files[b].parent_path();
    return x == y ? 0
           : std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end(),
                                          [](const fs::path& p, const fs::path& q) { return natural_less(p.native(), q.native()); })
               ? -1
               : 1;
  };
  std::sort(natural.begin(), natural.end(), [&](std::size_t a, std::size_t b) {
    const int folder = by_folder(a, b);
    return folder != 0 ? folder < 0 : natural_less(names[a].text, names[b].text);
  });
  std::vector<std::size_t> taken = natural;
  std::stable_sort(taken.begin(), taken.end(), [&](std::size_t a, std::size_t b) {
    const int folder = by_folder(a, b);
    return folder != 0 ? folder < 0 : earlier(names[a], names[b]);
  });

  TimeOrder order;
  std::vector<const Name*> in_order;
  for (const std::size_t k : taken) {
    order.clock.push_back(double(order.files.size()));
    order.files.push_back(std::move(files[k]));
    in_order.push_back(&names[k]);
  }
  if (taken != natural)
    order.remarks.push_back({"The frames are in the order of the numbers in their names, with their signs and decimals: " +
                            in_order[0]->text + ", " + in_order[1]->text + " ... " + in_order.back()->text + "."});
  else if (patterns.size() > 1)
    order.remarks.push_back({"The names of the frames are of " + std::to_string(patterns.size()) + " patterns ('" +
                            patterns.begin()->first + "' and '" + std::next(patterns.begin())->first +
                            "', # a number): the frames are taken in the order of their names, " + in_order[0]->text +
                            " ... " + in_order.back()->text + ".",
                             RemarkWeight::doubt});
  keep_gaps(in_order, order);
  return order;
}

}  // namespace pivnp::image
