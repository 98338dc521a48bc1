// SPDX-License-Identifier: GPL-3.0-or-later
declare module 'virtual:licences' {
  import type { Licence } from '../scripts/licences';
  const licences: readonly Licence[];
  export default licences;
}
