// Runs an image on a modelled RP2040 and prints what the image prints:
//
//   node rp2040.mjs IMAGE.bin
//
// The image is flash from its start, the vector table first.  BKPT 1 gives the cycles so far in r0; BKPT 0xAB is
// semihosting, of which it has SYS_WRITEC, SYS_WRITE0, SYS_WRITE and SYS_EXIT.
import { readFileSync } from "node:fs";
import { ConsoleLogger, LogLevel, RP2040 } from "rp2040js";

const FLASH = 0x10000000;
const CYCLES = 1, SEMIHOSTING = 0xab;
const OPEN = 1, WRITEC = 3, WRITE0 = 4, WRITE = 5, EXITS = [0x18, 0x20];

const chip = new RP2040();
chip.logger = new ConsoleLogger(LogLevel.Error);
chip.flash.set(readFileSync(process.argv[2]));
const core = chip.core;
let printed = "", running = true;

function print(address, length) {
  for (let n = 0; n < length; n++) printed += String.fromCharCode(chip.readUint8(address + n));
}

function serve(operation, argument) {
  if (operation === OPEN) return 1;
  if (operation === WRITEC) print(argument, 1);
  if (operation === WRITE0) for (let at = argument; chip.readUint8(at) !== 0; at++) print(at, 1);
  if (operation === WRITE) print(chip.readUint32(argument + 4), chip.readUint32(argument + 8));
  if (EXITS.includes(operation)) running = false;
  return 0;
}

chip.onBreak = (code) => {
  const [operation, argument] = core.registers;
  if (code === CYCLES) core.registers[0] = core.cycles;
  else if (code === SEMIHOSTING) core.registers[0] = serve(operation, argument);
  else throw new Error(`BKPT ${code} at 0x${core.PC.toString(16)}`);
};

core.VTOR = FLASH;
core.reset();
while (running) chip.step();
process.stdout.write(printed);
