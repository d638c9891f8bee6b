#include <clocale>
#include <cstdio>
#include <string>

#include <QApplication>
#include <QLocale>

#include "apps/view/window/main_window.hpp"
#include "pivnp/core/version.hpp"

namespace {

constexpr const char* usage =
    "Usage: pivnp-view [CASE | RECORD | FRAMES]\n\n"
    "The window of pivnp: sets a case up on its frames, runs it, and shows its record.\n"
    "CASE is a TOML file or a folder with case.toml, RECORD a record.h5, FRAMES a folder of images, a video or a pattern.\n";

}  // namespace

int main(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--help" || word == "-h") return std::fputs(usage, stdout), 0;
    if (word == "--version") return std::printf("pivnp-view %s (%s)\n", pivnp::build_info().version.c_str(), pivnp::build_info().commit.c_str()), 0;
  }
  QApplication::setApplicationName("pivnp-view");
  QApplication::setOrganizationName("pivnp");
  QApplication::setDesktopFileName("pivnp-view");
  QApplication app(argc, argv);
  std::setlocale(LC_NUMERIC, "C");  // cases and tables have points
  QLocale::setDefault(QLocale::c());
  app.setProperty("open_reports", true);
  const QStringList words = app.arguments();  // Qt has taken its own out
  if (words.size() > 2) {
    std::fprintf(stderr, "pivnp-view: error: found %d arguments, expected one case, record or folder of frames\n", int(words.size()) - 1);
    return 2;
  }
  pivnp::view::MainWindow window(true);
  window.show();
  if (words.size() == 2) window.open(words[1].toStdString());
  return QApplication::exec();
}
