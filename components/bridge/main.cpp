#include "common/bus/process.hpp"
#include "components/bridge/node.hpp"

int main(int argc, char** argv) { return handsel::run_process<handsel::bridge::Node>(argc, argv, "bridge"); }
