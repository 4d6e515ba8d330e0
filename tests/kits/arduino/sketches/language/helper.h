#pragma once
#include <Arduino.h>
#define HELP 11
long helped(int x);
