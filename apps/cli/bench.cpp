// coif bench: error against time for the choices a user has.
#include "../../bench/bench.h"

#include "command.h"
