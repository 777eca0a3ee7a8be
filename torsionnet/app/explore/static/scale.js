// The way of a slider: equal steps are equal factors where both ends have one sign.

export const STEPS = 1000;
const DIGITS = 4;

export function toPosition(value, slider) {
  const { low, high } = slider;
  const share = slider.logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  return Math.round(STEPS * Math.min(1, Math.max(0, share)));
}

// A position back at the file's own value is that value, to the last digit.
export function toValue(position, slider) {
  const { low, high } = slider;
  if (position === toPosition(slider.default, slider)) return slider.default;
  const share = position / STEPS;
  const value = slider.logarithmic ? low * (high / low) ** share : low + (high - low) * share;
  return Number(value.toPrecision(DIGITS));
}
