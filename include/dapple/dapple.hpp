// All of dapple's public interface.
#pragma once

#include "dapple/bake.hpp"
#include "dapple/bvh.hpp"
#include "dapple/device.hpp"
#include "dapple/error.hpp"
#include "dapple/film.hpp"
#include "dapple/moving_scene.hpp"
#include "dapple/options.hpp"
#include "dapple/points.hpp"
#include "dapple/render.hpp"
#include "dapple/scene.hpp"
