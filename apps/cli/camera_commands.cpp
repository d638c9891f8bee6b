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
    std::string images, corners = "9x6", lens = "brown", out = "out/calibrate";
    double square = 1;
    bool third = false;
  };
  const auto c = std::make_shared<Calibrate>();
  app.add_option("IMAGES", c->images, "pictures of a checkerboard: glob (quoted), printf pattern or folder")->required();
  app.add_option("--corners", c->corners, "inner corners of the board, COLUMNSxROWS (9x6)")->type_name("CxR");
  app.add_option("--square-m", c->square, "side of a square; the lens does not depend on it (1)")->check(CLI::PositiveNumber);
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
    const CalibrateOutcome found = calibrate_camera(
        c->images, board, c->lens == "fisheye" ? image::LensModel::fisheye : image::LensModel::brown, c->third, c->out);
    session.out << found.keys.string() << "\n" << found.picture.string() << "\n";
    if (!session.quiet)
      for (const std::string& remark : found.remarks) session.out << "note: " << remark << "\n";
    return 0;
  };
}

}  // namespace pivnp::app
