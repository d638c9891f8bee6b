// Opens an XDMF file with the Xdmf library (the one ParaView's Xdmf3 readers are built on) and prints what it read:
//   collection NAME
//   grid NAME TIME POINTS        points: x y z ...
//   attribute NAME VALUES...
// A program of its own: that library brings its own HDF5.
#include <XdmfAttribute.hpp>
#include <XdmfDomain.hpp>
#include <XdmfGeometry.hpp>
#include <XdmfGridCollection.hpp>
#include <XdmfReader.hpp>
#include <XdmfRegularGrid.hpp>
#include <XdmfTime.hpp>
#include <XdmfTopology.hpp>
#include <XdmfUnstructuredGrid.hpp>

#include <cstdio>

namespace {

void print_values(const char* what, const std::string& name, const shared_ptr<XdmfArray>& array) {
  if (!array->isInitialized()) array->read();
  std::printf("%s %s", what, name.c_str());
  for (unsigned k = 0; k < array->getSize(); ++k) std::printf(" %.9g", array->getValue<double>(k));
  std::printf("\n");
}

void print_attributes(const shared_ptr<XdmfGrid>& grid) {
  for (unsigned a = 0; a < grid->getNumberAttributes(); ++a)
    print_values("attribute", grid->getAttribute(a)->getName(), grid->getAttribute(a));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const shared_ptr<XdmfReader> reader = XdmfReader::New();
  const shared_ptr<XdmfDomain> domain = shared_dynamic_cast<XdmfDomain>(reader->read(argv[1]));
  for (unsigned c = 0; c < domain->getNumberGridCollections(); ++c) {
    const shared_ptr<XdmfGridCollection> collection = domain->getGridCollection(c);
    std::printf("collection %s\n", collection->getName().c_str());
    for (unsigned k = 0; k < collection->getNumberUnstructuredGrids(); ++k) {
      const shared_ptr<XdmfUnstructuredGrid> grid = collection->getUnstructuredGrid(k);
      std::printf("grid %s %.17g %u\n", grid->getName().c_str(), grid->getTime()->getValue(),
                  grid->getGeometry()->getNumberPoints());
      print_values("points", "position", grid->getGeometry());
      print_values("cells", "vertex", grid->getTopology());
      print_attributes(grid);
    }
    for (unsigned k = 0; k < collection->getNumberRegularGrids(); ++k) {
      const shared_ptr<XdmfRegularGrid> grid = collection->getRegularGrid(k);
      std::printf("grid %s %.17g %u\n", grid->getName().c_str(), grid->getTime()->getValue(), 0u);
      print_values("points", "origin", grid->getOrigin());
      print_values("points", "spacing", grid->getBrickSize());
      print_values("points", "nodes", grid->getDimensions());
      print_attributes(grid);
    }
  }
  return 0;
}
