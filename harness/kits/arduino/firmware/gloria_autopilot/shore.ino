// What comes from the shore and from the camera, by the Uno on Serial3, and what goes there. Sentences
// with a checksum: $PGLM a mark, $PGLS a sighting of an obstacle, $PGLT telemetry.

#ifdef TWO_BOARDS

const float OBSTACLE_DIAMETER = 1.0;  // what a sighting is taken for
const float CLEARANCE = 10.0, LOOKOUT_RANGE = 60.0;
const float NO_GO = 60.0 * DEG_TO_RAD;
const byte CONFIRMATIONS = 3;
const unsigned long FORGOTTEN_MS = 15000;

int series = 0, held = 0;       // number of the list of marks; bit i: mark i + 1 is there
float obstacleNorth = 0, obstacleEast = 0;
byte obstacleSeen = 0;
unsigned long obstacleAt = 0;
int8_t passingSide = 0;

char shoreLine[64];
byte shoreLength = 0;

void readShore() {
  while (Serial3.available()) {
    char c = Serial3.read();
    if (c == '$') shoreLength = 0;
    if (c == '\n') {
      shoreLine[shoreLength] = 0;
      if (isWhole(shoreLine)) takeShoreLine();
      shoreLength = 0;
    } else if (shoreLength < sizeof(shoreLine) - 1) {
      shoreLine[shoreLength++] = c;
    }
  }
}

bool isWhole(const char *text) {
  byte sum = 0;
  if (*text++ != '$') return false;
  while (*text && *text != '*') sum ^= *text++;
  return *text == '*' && strtol(text + 1, NULL, 16) == sum;
}

void takeShoreLine() {
  int list, number, total, size, bearing, radius;
  long n, e;
  char side;
  if (sscanf(shoreLine, "$PGLM,%d,%d,%d,%ld,%ld,%c,%d", &list, &number, &total, &n, &e, &side, &radius) == 7) {
    if (number < 1 || number > total || total > MOST_MARKS) return;
    if (list != series) {
      series = list;
      held = markCount = mark = 0;
    }
    marks[number - 1] = {n / 10.0f, e / 10.0f, (int8_t)(side == 'p' ? 1 : side == 's' ? -1 : 0), radius / 10.0f};
    held |= 1 << (number - 1);
    if (held == (1 << total) - 1) markCount = total;
  } else if (sscanf(shoreLine, "$PGLS,%d,%d", &bearing, &size) == 2 && size > 0) {
    float distance = OBSTACLE_DIAMETER / (size / 10.0f * DEG_TO_RAD);
    takeSighting(heading + bearing / 10.0f * DEG_TO_RAD, distance);
  }
}

// One obstacle is followed: the one that is seen again and again about the same place.
void takeSighting(float direction, float distance) {
  float n = north + distance * cos(direction), e = east + distance * sin(direction);
  float off = sqrt((n - obstacleNorth) * (n - obstacleNorth) + (e - obstacleEast) * (e - obstacleEast));
  if (obstacleSeen && off < 5.0 + distance / 3.0) {
    obstacleNorth += 0.4 * (n - obstacleNorth);
    obstacleEast += 0.4 * (e - obstacleEast);
    if (obstacleSeen < CONFIRMATIONS) obstacleSeen++;
    obstacleAt = millis();
  } else if (obstacleSeen < CONFIRMATIONS) {
    obstacleNorth = n;
    obstacleEast = e;
    obstacleSeen = 1;
    obstacleAt = millis();
  }
}

// The heading nearest to the wanted one that passes the obstacle at its clearance, not into the wind.
float clearOfObstacle(float wanted) {
  if (obstacleSeen && millis() - obstacleAt > FORGOTTEN_MS) obstacleSeen = 0;
  float n = obstacleNorth - north, e = obstacleEast - east, distance = sqrt(n * n + e * e);
  float direction = atan2(e, n);
  float half = distance > CLEARANCE ? asin(CLEARANCE / distance) : HALF_PI;
  float off = wrapped(wanted - direction);
  if (obstacleSeen < CONFIRMATIONS || distance > LOOKOUT_RANGE || abs(off) >= half) {
    passingSide = 0;
    return wanted;
  }
  if (!passingSide) passingSide = off >= 0 ? 1 : -1;
  float eye = atan2(-windEast, -windNorth);
  if (abs(wrapped(direction + passingSide * half - eye)) < NO_GO) passingSide = -passingSide;
  return wrapped(direction + passingSide * half);
}

void reportToShore() {
  char text[64];
  snprintf(text, sizeof(text), "$PGLT,%d,%d,%d,%ld,%ld,%d,%d", series, held, mark, lround(north * 10), lround(east * 10),
           (int)lround((heading < 0 ? heading + TWO_PI : heading) * RAD_TO_DEG * 10), (int)lround(speedOver * 100));
  byte sum = 0;
  for (char *at = text + 1; *at; at++) sum ^= *at;
  char check[6];
  snprintf(check, sizeof(check), "*%02X", sum);
  Serial3.print(text);
  Serial3.println(check);
}

#endif
