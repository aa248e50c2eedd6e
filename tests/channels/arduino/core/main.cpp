/* An emulated board: Serial is semihosting, and what would run for ever runs three times.
 *
 * SPDX-License-Identifier: MIT
 */
#include "Arduino.h"

#include <stdio.h>

EmulatedSerial Serial;

void EmulatedSerial::print(char c) { putchar(c); }
void EmulatedSerial::print(const char *text) { printf("%s", text); }
void EmulatedSerial::print(int number) { printf("%d", number); }

/* Nine digits, however many are wanted: they tell all bits of a float. */
void EmulatedSerial::print(double number, int) { printf("%.9g", number); }

void EmulatedSerial::println() { putchar('\n'); }
void EmulatedSerial::println(const char *text) { puts(text); }
void EmulatedSerial::println(double number, int digits)
{
    print(number, digits);
    println();
}

/* A clock that goes on by 1.25 ms whenever somebody looks. */
unsigned long micros()
{
    static unsigned long now;
    return now += 1250;
}
unsigned long millis() { return micros() / 1000; }
void delay(unsigned long) {}

int main()
{
    setup();
    for (int turn = 0; turn < 3; turn++) loop();
    return 0;
}
