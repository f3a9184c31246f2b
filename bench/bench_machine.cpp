#include <sys/utsname.h>

#include <fstream>
#include <thread>

#include "bench/bench.h"

namespace coif {

BenchMachine benchMachine() {
  BenchMachine machine;
  machine.compiler = COIF_COMPILER;
  machine.build = COIF_BUILD_TYPE;
  machine.version = COIF_VERSION;
  machine.threads = int(std::thread::hardware_concurrency());
  machine.processor = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t colon = line.find(':');
    if (colon != std::string::npos) machine.processor = line.substr(std::min(line.size(), colon + 2));
    break;
  }
  utsname system{};
  machine.system =
      uname(&system) == 0 ? std::string(system.sysname) + " " + system.machine : "unknown system";
  return machine;
}

}  // namespace coif
