#include "apps/study/frontier/tables.hpp"

#include <cmath>

#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

// Quoted where a comma or a quotation mark would end the cell.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char ch : text) out += ch == '"' ? std::string("\"\"") : std::string(1, ch);
  return out + "\"";
}

}  // namespace

io::NamedTable table_of(const FrontierStage& stage, const std::string& machine, int threads) {
  const auto numbers = [&](const auto& of) {
    std::vector<double> all;
    for (const FrontierPoint& p : stage.points) all.push_back(of(p));
    return all;
  };
  const auto texts = [&](const auto& of) {
    std::vector<std::string> all;
    for (const FrontierPoint& p : stage.points) all.push_back(of(p));
    return all;
  };
  io::NamedTable t{stage.name, {{"made_of", stage.made_of}, {"error", stage.error_label}, {"time", stage.time_label}, {"machine", machine}, {"threads", std::to_string(threads)}}, {}};
  t.columns.push_back({.name = "setting", .texts = texts([](const FrontierPoint& p) { return p.name; })});
  t.columns.push_back({.name = "keys", .texts = texts([](const FrontierPoint& p) { return p.keys; })});
  t.columns.push_back({.name = "seconds", .unit = "s", .numbers = numbers([](const FrontierPoint& p) { return p.seconds; })});
  t.columns.push_back({.name = "seconds_least", .unit = "s", .numbers = numbers([](const FrontierPoint& p) { return p.quickest; })});
  t.columns.push_back({.name = "seconds_most", .unit = "s", .numbers = numbers([](const FrontierPoint& p) { return p.slowest; })});
  t.columns.push_back({.name = "peak_bytes", .unit = "B", .numbers = numbers([](const FrontierPoint& p) { return p.bytes; })});
  t.columns.push_back({.name = "instructions", .numbers = numbers([](const FrontierPoint& p) { return p.instructions; })});
  t.columns.push_back({.name = "error", .numbers = numbers([](const FrontierPoint& p) { return p.error; })});
  t.columns.push_back({.name = "worst", .numbers = numbers([](const FrontierPoint& p) { return p.worst; })});
  for (std::size_t k = 0; k < stage.columns.size(); ++k)
    t.columns.push_back({.name = stage.columns[k].name, .numbers = numbers([k](const FrontierPoint& p) { return p.columns[k]; })});
  t.columns.push_back({.name = "on_front", .numbers = numbers([](const FrontierPoint& p) { return double(p.on_front); })});
  t.columns.push_back({.name = "default", .numbers = numbers([](const FrontierPoint& p) { return double(p.standard); })});
  t.columns.push_back({.name = "case", .numbers = numbers([](const FrontierPoint& p) { return double(p.own); })});
  t.columns.push_back({.name = "elsewhere", .numbers = numbers([](const FrontierPoint& p) { return double(p.elsewhere); })});
  return t;
}

std::string csv(const FrontierStage& stage) {
  std::string out = "setting,keys,seconds,seconds_least,seconds_most,peak_bytes,instructions,error,worst";
  for (const FrontierColumn& column : stage.columns) out += "," + column.name;
  out += ",on_front,default,case,elsewhere\n";
  for (const FrontierPoint& p : stage.points) {
    out += cell(p.name) + "," + cell(p.keys);
    for (const double v : {p.seconds, p.quickest, p.slowest, p.bytes, p.instructions, p.error, p.worst}) out += "," + (std::isfinite(v) ? number(v, 6) : "");
    for (const double v : p.columns) out += "," + (std::isfinite(v) ? number(v, 6) : "");
    out += std::string(p.on_front ? ",1" : ",0") + (p.standard ? ",1" : ",0") + (p.own ? ",1" : ",0") + (p.elsewhere ? ",1\n" : ",0\n");
  }
  return out;
}

}  // namespace pivnp::app
