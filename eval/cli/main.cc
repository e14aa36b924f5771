#include "eval/cli/command.h"

int main(int argc, char** argv) { return moma::cli::run_program(moma::cli::Arguments(argv, argv + argc)); }
