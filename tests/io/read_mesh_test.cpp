#include "patches/io/read_mesh.h"
#include <gtest/gtest.h>
