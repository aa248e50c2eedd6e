/* What the example asks of Arduino, on an emulated board.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef ARDUINO_H
#define ARDUINO_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

void setup();
void loop();

unsigned long millis();
unsigned long micros();
void delay(unsigned long ms);

class EmulatedSerial {
public:
    void begin(unsigned long) {}
    operator bool() const { return true; }
    void print(char c);
    void print(const char *text);
    void print(int number);
    void print(double number, int digits = 2);
    void println();
    void println(const char *text);
    void println(double number, int digits = 2);
};

extern EmulatedSerial Serial;

#endif
