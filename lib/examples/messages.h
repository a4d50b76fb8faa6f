// What a cluster head hears in this example: from a radio, in the end.
#pragma once

#include <stdint.h>

enum { joins, moves, leaves, road };

typedef struct {
  uint8_t kind;
  uint8_t device;  // of a road: where it begins, ...
  uint8_t other;   // ... and where it ends
  int32_t x;       // metres from the cluster head
  int32_t y;
} message_t;

static const message_t messages[] = {
    {joins, 0, 0, -400, -300}, {joins, 1, 0, 500, -280},  {joins, 2, 0, 450, 410},
    {joins, 3, 0, -380, 390},  {joins, 4, 0, 20, 60},     {road, 0, 2, 0, 0},
    {joins, 5, 0, 180, 40},    {joins, 6, 0, -150, -190}, {road, 3, 4, 0, 0},
    {moves, 5, 0, 200, 90},    {joins, 7, 0, 20, 60},     {road, 1, 3, 0, 0},
    {leaves, 6, 0, 0, 0},      {moves, 2, 0, 480, 430},   {leaves, 0, 0, 0, 0},
};
