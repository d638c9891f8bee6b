// The command on a camera's pictures of a board.
#include <CLI/CLI.hpp>
#include <memory>
#include <ostream>

#include "apps/cli/arguments.hpp"
#include "apps/cli/commands.hpp"
#include "pivnp/core/error.hpp"
#include "apps/study/studies/calibrate.hpp"

namespace pivnp::app {

Action declare_calibrate(CLI::App& app, Session& session) {
  struct Calibrate {
    std::string images, corners = "9x6", lens = "brown", out = "out/calibrate", charuco;
    double square = 1, marker = 0;
    bool third = false;
  };
  const auto c = std::make_shared<Calibrate>();
  app.add_option("IMAGES", c->images, "pictures of a checkerboard or ChArUco board: glob (quoted), printf pattern or folder")->required();
  app.add_option("--corners", c->corners, "inner corners of the board, COLUMNSxROWS (9x6)")->type_name("CxR");
  app.add_option("--square-m", c->square, "side of a square; the lens does not depend on it (1)")->check(CLI::PositiveNumber);
  CLI::Option* const charuco = app.add_option("--charuco", c->charuco, "the white squares hold markers of this dictionary (4x4_50, 5x5_100, ...; see docs/filming.md); "
                                                                       "the board may be seen in part")->type_name("DICTIONARY");
  CLI::Option* const marker = app.add_option("--marker-m", c->marker, "side of a marker, with --charuco")->check(CLI::PositiveNumber);
  charuco->needs(marker);
  marker->needs(charuco);
  app.add_option("--lens", c->lens, "model of the lens: brown, fisheye (brown)")->check(CLI::IsMember({"brown", "fisheye"}));
  app.add_flag("--k3", c->third, "a third radial coefficient (brown)");
  app.add_option("--out", c->out, "receives camera.toml and residuals.png (out/calibrate)")->type_name("DIR");
  add_session(app, session);
  return [c, &session] {
    image::Board board;
    char extra = 0;
    if (std::sscanf(c->corners.c_str(), "%dx%d%c", &board.columns, &board.rows, &extra) != 2)
      throw InputError("--corners: found '" + c->corners + "', expected COLUMNSxROWS, as in 9x6");
    board.square = c->square;
    board.dictionary = c->charuco;
    board.marker = c->marker;
    const CalibrateOutcome found = calibrate_camera(
        c->images, board, c->lens == "fisheye" ? image::LensModel::fisheye : image::LensModel::brown, c->third, c->out);
    session.out << found.keys.string() << "\n" << found.picture.string() << "\n";
    if (!session.quiet)
      for (const std::string& remark : found.remarks) session.out << "note: " << remark << "\n";
    return 0;
  };
}

}  // namespace pivnp::app
