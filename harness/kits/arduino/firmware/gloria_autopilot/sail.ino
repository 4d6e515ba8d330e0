// The sail's stepper motor: pulses to its driver. It has a gear of 20 and half steps, and begins with
// the sail open to port.

#ifdef TWO_BOARDS

const byte STEP_PIN = 22, DIRECTION_PIN = 23;
const float PULSES_PER_RAD = 20.0 * 400.0 / TWO_PI;
const float FASTEST = 1000.0, ACCELERATION = 5000.0;  // pulses a second, and that a second

long sailSteps = 0, sailAim = 0;
float pulseRate = 0;
unsigned long pulseAt = 0;

void beginSail() {
  pinMode(STEP_PIN, OUTPUT);
  pinMode(DIRECTION_PIN, OUTPUT);
  sailSteps = sailAim = lround(HALF_PI * PULSES_PER_RAD);
}

// Every control period: where to, and how fast without running past it.
void aimSail(float angle) {
  sailAim = lround(angle * PULSES_PER_RAD);
  float left = abs(sailAim - sailSteps);
  float most = min(FASTEST, (float)sqrt(2.0 * ACCELERATION * left) + 50.0);
  pulseRate = min(most, pulseRate + ACCELERATION * (CONTROL_MS / 1000.0f));
  if (sailAim == sailSteps) pulseRate = 0;
}

// As often as possible: a pulse if one is due.
void turnSail() {
  if (sailSteps == sailAim || pulseRate < 1.0) {
    pulseAt = micros();
    return;
  }
  if ((long)(micros() - pulseAt) < 0) return;
  bool up = sailAim > sailSteps;
  digitalWrite(DIRECTION_PIN, up);
  digitalWrite(STEP_PIN, HIGH);
  sailSteps += up ? 1 : -1;
  pulseAt += (unsigned long)(1e6 / pulseRate);
  digitalWrite(STEP_PIN, LOW);
}

#endif
