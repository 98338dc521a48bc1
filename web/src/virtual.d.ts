// SPDX-License-Identifier: GPL-3.0-or-later
declare module 'virtual:licences' {
  const licences: readonly import('../scripts/licences').Licence[];
  export default licences;
}
