// The kernel in WebAssembly and its memory: one block of doubles for each instance.

import { unpacked } from "./packed";
import { embedded, tables } from "./tables";

/** Operation, addresses of the records p, d, u, x, y and w, communication step in s. Answers a status. */
type Call = (operation: bigint, p: number, d: number, u: number, x: number, y: number, w: number, step: number) => bigint;

interface Kernel {
  call: Call;
  memory: WebAssembly.Memory;
}

const BYTES = 8;
const PAGE = 65536;
const doubles = tables.sizes.reduce((sum, size) => sum + size, 0);
const released: number[] = [];
let kernel: Kernel | undefined;
let end = 0;

/** Unpack and compile the kernel of the viewer. */
async function load(): Promise<void> {
  const { instance } = await WebAssembly.instantiate(await unpacked(embedded("kernel")), {});
  const { memory, __heap_base: base } = instance.exports;
  if (!(memory instanceof WebAssembly.Memory) || !(base instanceof WebAssembly.Global)) {
    throw new Error("the kernel must export its memory and __heap_base");
  }
  kernel = { call: instance.exports[tables.symbol] as Call, memory };
  end = Math.ceil(Number(base.value) / BYTES) * BYTES;
}

/** When the kernel can be called. */
export const ready: Promise<void> = load();

function loaded(): Kernel {
  if (!kernel) throw new Error("the kernel is still being loaded: wait for ready");
  return kernel;
}

/** The records of one instance. */
export class Records {
  private readonly addresses: number[];
  private readonly start: number;
  private numbers: Float64Array = new Float64Array();

  constructor() {
    this.start = released.pop() ?? reserve();
    let at = this.start;
    this.addresses = tables.sizes.map((size) => (at += size * BYTES) - size * BYTES);
    this.view().fill(0);
  }

  /** Where in the doubles of the instance a record begins. */
  offset(record: number): number {
    return ((this.addresses[record] ?? NaN) - this.start) / BYTES;
  }

  /** All doubles of the instance; not to be kept, for the memory may grow. */
  view(): Float64Array {
    const { buffer } = loaded().memory;
    if (this.numbers.buffer !== buffer) this.numbers = new Float64Array(buffer, this.start, doubles);
    return this.numbers;
  }

  /** Call the kernel with these records. Returns its status. */
  call(operation: number, step: number): number {
    const [p = NaN, d = NaN, u = NaN, x = NaN, y = NaN, w = NaN] = this.addresses;
    return Number(loaded().call(BigInt(operation), p, d, u, x, y, w, step));
  }

  /** Let another instance have the memory; this one cannot be used any more. */
  release(): void {
    released.push(this.start);
  }
}

/** Address of a new block of memory. */
function reserve(): number {
  const { memory } = loaded();
  const start = end;
  end += doubles * BYTES;
  const missing = end - memory.buffer.byteLength;
  if (missing > 0) memory.grow(Math.ceil(missing / PAGE));
  return start;
}
