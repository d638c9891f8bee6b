#include "apps/report/document/player.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>

#include <QByteArray>

#include "apps/plot/numbers.hpp"
#include "apps/report/content/fields.hpp"
#include "apps/report/content/selection.hpp"
#include "apps/report/document/text.hpp"
#include "apps/report/words/words.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr std::size_t most_times = 15, most_particles = 5000, most_fields = 2;

// Plain script, no library: it draws squares on canvases, and says the value of the particle nearest to the pointer.
constexpr std::string_view script = R"JS(
(function () {
  "use strict";
  var root = document.getElementById("player");
  var meta = JSON.parse(document.getElementById("player-data").textContent);
  var raw = atob(document.getElementById("player-values").textContent.trim());
  var bytes = new Uint8Array(raw.length);
  for (var b = 0; b < raw.length; ++b) bytes[b] = raw.charCodeAt(b);
  var data = new Float32Array(bytes.buffer);
  var slider = root.querySelector("input"), choice = root.querySelector("select");
  var clock = root.querySelector("output"), said = root.querySelector(".said"), bar = root.querySelector(".bar");
  var canvases = root.querySelectorAll("canvas.side");
  var width = meta.box[2] - meta.box[0], height = meta.box[3] - meta.box[1];
  var probe = [NaN, NaN];
  function colour(t) {
    var k = Math.max(0, Math.min(255, Math.floor(t * 256)));
    return "#" + meta.fields[+choice.value].colours.substr(6 * k, 6);
  }
  function number(v) {
    if (!isFinite(v)) return "not known";
    return String(Number(v.toPrecision(5)));
  }
  function block(s) {
    var at = 0;
    for (var k = 0; k < s; ++k) at += meta.sides[k].count * (2 + meta.fields.length) * meta.times.length;
    return at + (+slider.value) * meta.sides[s].count * (2 + meta.fields.length);
  }
  function draw(s) {
    var canvas = canvases[s], side = meta.sides[s], n = side.count, at = block(s), f = +choice.value, field = meta.fields[f];
    var ratio = window.devicePixelRatio || 1, w = Math.max(50, canvas.clientWidth);
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(w * ratio * height / width);
    var c = canvas.getContext("2d"), scale = canvas.width / width, size = Math.max(1.5, side.size * scale);
    for (var p = 0; p < n; ++p) {
      var x = data[at + p], y = data[at + n + p], v = data[at + (2 + f) * n + p];
      if (!isFinite(x)) continue;
      c.fillStyle = isFinite(v) ? colour((v - field.lower) / (field.upper - field.lower)) : "#b0b0b0";
      c.fillRect((x - meta.box[0]) * scale - size / 2, canvas.height - (y - meta.box[1]) * scale - size / 2, size, size);
    }
    if (isFinite(probe[0])) {
      c.strokeStyle = "#d55e00";
      c.lineWidth = 2 * ratio;
      c.beginPath();
      c.arc((probe[0] - meta.box[0]) * scale, canvas.height - (probe[1] - meta.box[1]) * scale, 6 * ratio, 0, 7);
      c.stroke();
    }
  }
  function say() {
    var field = meta.fields[+choice.value], f = +choice.value, text = [];
    if (isFinite(probe[0]))
      meta.sides.forEach(function (side, s) {
        var n = side.count, at = block(s), best = -1, least = Infinity;
        for (var p = 0; p < n; ++p) {
          var dx = data[at + p] - probe[0], dy = data[at + n + p] - probe[1], d = dx * dx + dy * dy;
          if (d < least) { least = d; best = p; }
        }
        if (best < 0 || least > 2.3 * side.size * side.size) text.push(side.name + ": no material here");
        else text.push(side.name + ": " + number(data[at + (2 + f) * n + best] * field.factor) + " " + field.unit + " at (" +
                       number(data[at + best]) + ", " + number(data[at + n + best]) + ") " + meta.length);
      });
    said.textContent = text.length ? text.join("; ") : "Point at the material, or move a circle over it with the arrow keys, to read values.";
  }
  function show() {
    var field = meta.fields[+choice.value];
    clock.textContent = number(meta.times[+slider.value]) + " " + meta.time;
    slider.setAttribute("aria-valuetext", clock.textContent);
    for (var s = 0; s < canvases.length; ++s) draw(s);
    bar.style.background = "linear-gradient(to right," + [0, .125, .25, .375, .5, .625, .75, .875, 1].map(colour).join(",") + ")";
    root.querySelector(".low").textContent = number(field.lower * field.factor);
    root.querySelector(".high").textContent = number(field.upper * field.factor) + " " + field.unit;
    say();
  }
  canvases.forEach(function (canvas, s) {
    canvas.addEventListener("pointermove", function (e) {
      var r = canvas.getBoundingClientRect();
      probe = [meta.box[0] + (e.clientX - r.left) / r.width * width, meta.box[3] - (e.clientY - r.top) / r.height * height];
      show();
    });
    canvas.addEventListener("keydown", function (e) {
      var step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key];
      if (!step) return;
      if (!isFinite(probe[0])) probe = [(meta.box[0] + meta.box[2]) / 2, (meta.box[1] + meta.box[3]) / 2];
      probe = [probe[0] + .02 * width * step[0], probe[1] + .02 * width * step[1]];
      e.preventDefault();
      show();
    });
  });
  slider.addEventListener("input", show);
  choice.addEventListener("change", show);
  window.addEventListener("resize", show);
  show();
})();
)JS";

std::string json_text(const std::string& text) {
  std::string out = "\"";
  for (const char ch : clean_utf8(text)) {
    if (ch == '"' || ch == '\\') out += '\\';
    if (ch == '<') out += "\\u003c";  // a script's text must not end it
    else out += ch == '\n' || ch == '\t' ? ' ' : ch;
  }
  return out + "\"";
}

std::string base64(const std::vector<std::vector<float>>& rows) {
  static_assert(std::endian::native == std::endian::little, "browsers read little-endian floats");
  QByteArray bytes;
  for (const std::vector<float>& row : rows)
    bytes.append(reinterpret_cast<const char*>(row.data()), qsizetype(row.size() * sizeof(float)));
  return bytes.toBase64().toStdString();
}

std::string colours(Colours map) {
  std::string text;
  char hex[8];
  for (int k = 0; k < 256; ++k) {
    std::snprintf(hex, sizeof hex, "%06x", unsigned(colour_at(map, (k + 0.5) / 256)) & 0xffffffu);
    text += hex;
  }
  return text;
}

// Up to so many, evenly, with the first and the last.
std::vector<double> some_times(const std::vector<double>& all) {
  if (all.size() <= most_times) return all;
  std::vector<double> some;
  for (std::size_t k = 0; k < most_times; ++k) some.push_back(all[k * (all.size() - 1) / (most_times - 1)]);
  return some;
}

}  // namespace

std::optional<Player> player_of(const ReportOptions& options, const Content& content, const DataSetNames& names, bool central) {
  Player player;
  player.length_unit = content.length_unit;
  player.time_unit = content.time_unit;
  const MotionSource* leading = content.measured ? content.measured.get() : content.simulated.get();
  if (leading == nullptr) return std::nullopt;
  const bool compared = content.comparison && !content.comparison->times().empty();
  player.times = some_times(compared ? content.comparison->times() : leading->times());
  if (player.times.size() < 2) return std::nullopt;
  std::vector<std::string> fields = options.fields_drawn;
  fields.resize(std::min(fields.size(), most_fields));
  if (fields.empty()) return std::nullopt;
  std::vector<std::vector<double>> values(fields.size());
  std::vector<std::vector<Vec2>> places;
  for (const auto& [motion, name] : {std::pair{content.measured, names.first}, {content.simulated, names.second}}) {
    if (!motion) continue;
    const ParticleSet& set = motion->particles();
    const std::size_t stride = set.size() / most_particles + 1;
    Player::Side side;
    side.name = name;
    for (std::size_t p = 0; p < set.size(); p += stride) ++side.count;
    side.values.assign(player.times.size(), std::vector<float>(side.count * (2 + fields.size()), float(nan_value)));
    std::vector<double> sizes;
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const std::vector<FieldAtTime> all = fields_at(*motion, fields[f], central, player.times);
      for (std::size_t t = 0; t < all.size(); ++t) {
        const FieldAtTime& at = all[t];
        if (f == 0) places.push_back(at.position);
        for (std::size_t p = 0, q = 0; p < at.position.size(); p += stride, ++q) {
          if (at.status[p] == ParticleStatus::unborn) continue;
          if (f == 0) {
            side.values[t][q] = float(at.position[p].x());
            side.values[t][side.count + q] = float(at.position[p].y());
            sizes.push_back(particle_spacing(set, p));
          }
          side.values[t][(2 + f) * side.count + q] = float(at.value[p]);
          values[f].push_back(at.value[p]);
        }
      }
    }
    side.size = (stride > 1 ? 1.5 : 1.1) * std::sqrt(double(stride)) * quantile(sizes, 0.5);
    player.sides.push_back(std::move(side));
  }
  std::vector<const std::vector<Vec2>*> lists;
  for (const auto& list : places) lists.push_back(&list);
  player.box = box_around(lists, 0.001);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const DerivedField field = derived_field(fields[f]);
    player.fields.push_back({field.label, field_unit(field, content), scale_for(values[f], false)});
  }
  return player;
}

std::string html_of(const Player& player) {
  std::string out = "<section id=\"player\" aria-label=\"Fields through time\">\n<div class=\"controls\"><label>Time <input type=\"range\" min=\"0\" max=\"" +
                    std::to_string(player.times.size() - 1) + "\" step=\"1\" value=\"" + std::to_string(player.times.size() - 1) +
                    "\"></label> <output>\u2013</output> <label>Field <select>";
  for (std::size_t f = 0; f < player.fields.size(); ++f)
    out += "<option value=\"" + std::to_string(f) + "\">" + escape_html(player.fields[f].label) + "</option>";
  out += "</select></label></div>\n<div class=\"pair\">";
  for (const Player::Side& side : player.sides)
    out += "<div><p class=\"name\">" + escape_html(capitalised(side.name)) + "</p><canvas class=\"side\" tabindex=\"0\" role=\"img\" aria-label=\"" +
           escape_html("Particles of the " + side.name + " motion, coloured by the field") + "\"></canvas></div>";
  out += "</div>\n<div class=\"scale\"><span class=\"low\">0</span><span class=\"bar\">&nbsp;</span><span class=\"high\">1</span></div>\n"
         "<p class=\"said\" aria-live=\"polite\">The slider needs JavaScript; the figures below do not.</p>\n";
  std::string meta = "{\"times\":[";
  for (std::size_t k = 0; k < player.times.size(); ++k) meta += (k > 0 ? "," : "") + number(player.times[k], 9);
  meta += "],\"time\":" + json_text(player.time_unit) + ",\"length\":" + json_text(player.length_unit) + ",\"box\":[" + number(player.box.lower.x(), 9) +
          "," + number(player.box.lower.y(), 9) + "," + number(player.box.upper.x(), 9) + "," + number(player.box.upper.y(), 9) + "],\"sides\":[";
  std::vector<std::vector<float>> values;
  for (std::size_t s = 0; s < player.sides.size(); ++s) {
    const Player::Side& side = player.sides[s];
    meta += std::string(s > 0 ? "," : "") + "{\"name\":" + json_text(side.name) + ",\"count\":" + std::to_string(side.count) + ",\"size\":" +
            number(std::isfinite(side.size) && side.size > 0 ? side.size : player.box.width() / 60, 6) + "}";
    values.insert(values.end(), side.values.begin(), side.values.end());
  }
  meta += "],\"fields\":[";
  for (std::size_t f = 0; f < player.fields.size(); ++f) {
    const Player::Field& field = player.fields[f];
    const plot::DisplayUnit shown =
        plot::display_unit(field.unit, std::max(std::abs(field.scale.lower), std::abs(field.scale.upper)));
    meta += std::string(f > 0 ? "," : "") + "{\"unit\":" + json_text(plot::unit_words(shown.name)) + ",\"factor\":" + number(shown.factor, 6) + ",\"lower\":" + number(field.scale.lower, 6) +
            ",\"upper\":" + number(field.scale.upper, 6) + ",\"colours\":\"" + colours(field.scale.map) + "\"}";
  }
  out += "<script type=\"application/json\" id=\"player-data\">" + meta + "]}</script>\n";
  out += "<script type=\"text/plain\" id=\"player-values\">" + base64(values) + "</script>\n<script>" + std::string(script) + "</script>\n</section>\n";
  return out;
}

}  // namespace pivnp::report
