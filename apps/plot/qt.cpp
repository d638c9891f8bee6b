#include "apps/plot/qt.hpp"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <QApplication>
#include <QFontMetricsF>
#include <QLocale>
#include <QThreadPool>

#include "apps/plot/canvas.hpp"

namespace pivnp::plot {

namespace {

// A folder that nobody else can have made before, as long as the process lives.
class OwnCache {
 public:
  OwnCache() {
    std::error_code none;
    folder_ = (std::filesystem::temp_directory_path(none) / "pivnp-XXXXXX").string();
    if (none || ::mkdtemp(folder_.data()) == nullptr) folder_.clear();
    else ::setenv("XDG_CACHE_HOME", folder_.c_str(), 1);
  }
  ~OwnCache() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }
  OwnCache(const OwnCache&) = delete;
  OwnCache& operator=(const OwnCache&) = delete;

 private:
  std::string folder_;
};

}  // namespace

void start_qt() {
  if (QCoreApplication::instance() != nullptr) return;
  // A record may be reported on by a service without a home; fontconfig then looks for a place for its cache.
  if (std::getenv("HOME") == nullptr && std::getenv("XDG_CACHE_HOME") == nullptr) static const OwnCache cache;
  ::setenv("QT_NO_GLIB", "1", 0);  // GLib aborts where memory ends, and there are no events here
  const char* before = std::setlocale(LC_ALL, nullptr);
  const std::string locale = before == nullptr ? "C" : before;
  // On the command line of Qt, so that a platform from the environment that cannot be reached does not end the program.
  static char name[] = "pivnp", option[] = "-platform", platform[] = "offscreen";
  static char* argv[] = {name, option, platform, nullptr};
  static int argc = 3;
  // Remarks on the desktop's folders mean nothing here.
  const QtMessageHandler handler =
      qInstallMessageHandler([](QtMsgType type, const QMessageLogContext&, const QString& text) {
        if (type == QtCriticalMsg || type == QtFatalMsg) std::fprintf(stderr, "Qt: %s\n", qPrintable(text));
      });
  QThreadPool::globalInstance()->setMaxThreadCount(1);  // canvas.cpp sees to it that one can be made
  new QApplication(argc, argv);  // lives as long as the process: Qt does not outlive static destruction well
  qInstallMessageHandler(handler);
  std::setlocale(LC_ALL, locale.c_str());
  QLocale::setDefault(QLocale::c());
}

QColor qt_colour(Rgb rgb, int alpha) {
  return QColor(int(rgb >> 16 & 0xff), int(rgb >> 8 & 0xff), int(rgb & 0xff), alpha);
}

QFont qt_font(double points, bool bold) {
  QFont f(QStringLiteral("DejaVu Sans"));
  f.setPixelSize(std::max(1, int(std::lround(points * units_per_point))));
  f.setBold(bold);
  f.setHintingPreference(QFont::PreferNoHinting);
  return f;
}

QPen qt_pen(const Pen& pen) {
  const Qt::PenStyle style = pen.dash == Dash::dashed    ? Qt::DashLine
                             : pen.dash == Dash::dotted   ? Qt::DotLine
                             : pen.dash == Dash::dash_dot ? Qt::DashDotLine
                                                          : Qt::SolidLine;
  return QPen(qt_colour(pen.rgb, pen.alpha), pen.points * units_per_point, style, Qt::FlatCap, Qt::RoundJoin);
}

double text_width(const std::string& words, double points, bool bold) {
  return QFontMetricsF(qt_font(points, bold)).horizontalAdvance(qt(words)) / units_per_mm;
}

}  // namespace pivnp::plot
