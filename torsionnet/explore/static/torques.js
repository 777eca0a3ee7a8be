// Mean torques of elements as a table, where the drivetrain has an operating point.

export function drawTorques(place, table, found) {
  const rows = Object.entries(found.elements ?? {});
  place.hidden = !rows.length;
}
