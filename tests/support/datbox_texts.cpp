// SPDX-License-Identifier: GPL-3.0-or-later
#include "datbox_texts.hpp"

#include "spoilt.hpp"

namespace nscdd::testing {

DatboxTexts small_datbox() {
  DatboxTexts texts;
  texts.bodies = R"(! File BODIES

$bdyty
 RBDY2      1
$blmty
 PLAIN      1  behav  STONE  avrd= 0.2000000D+00  gyrd= 0.1767767D+00
$nodty
 NO3xx      1                coo1= 0.1000000D+01  coo2= 0.2000000D+01  coo3= 0.0000000D+00
$tacty
 DISKx      1  color  BLEUx  byrd= 0.2500000D+00
$$$$$$

$bdyty
 RBDY2      2
$blmty
 PLAIN      1  behav  HARDx  avrd= 0.1000000D+01  gyrd= 0.1000000D+01
$nodty
 NO3xx      1                coo1= 0.0000000D+00  coo2=-5.0000000E-01  coo3= 5.2359878E-01
$tacty
 JONCx      1  color  WALLx  ax1 = 3.0000000E+00  ax2 = 5.0000000E-01
$$$$$$

$bdyty
 RBDY2      3
$blmty
 PLAIN      1  behav  HARDx  avrd= 0.0000000D+00  gyrd= 0.0000000D+00
$nodty
 NO3xx      1                coo1= 0.1000000D+02  coo2= 0.2000000D+02  coo3= 0.1570796D+01
$tacty
 DISKb      1  color  ROUGE  byrd= 0.1000000D+01
                             coo1= 0.3000000D+01  coo2= 0.0000000D+00
 DISKb      2  color  ROUGE  byrd= 0.2000000D+01
                             coo1= 0.0000000D+00  coo2= 0.4000000D+01
$$$$$$
)";
  texts.bulk = R"($gravy
                   grv1= 0.1250000D+01  grv2=-0.9810000D+01  grv3= 0.0000000D+00

$behav  lawty
 STONE  RIGID                           Umas= 0.1000000D+04

$behav  lawty
 HARDx  RIGID                           Umas= 0.5000000D+04
)";
  texts.tact = R"($behav  lawty
 iqsc0  IQS_CLB                         fric= 0.3000000D+00

$behav  lawty
 other  MAC_CZM                         dyfr= 0.3000000D+00  stfr= 0.5000000D+00

$behav  lawty
 iqsc1  IQS_CLB                         fric= 0.5000000D+00

$seety
 cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert
 RBDY2  DISKx  BLEUx  iqsc1  RBDY2  JONCx  WALLx       0.5000000D-01
$seety
 cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert
 RBDY2  DISKx  ROUGE  iqsc1  RBDY2  DISKx  BLEUx       0.1000000D+00
)";
  texts.driven = R"($bdyty
 RBDY2        2
$nodty
 NO3xx      1
$dofty  numbr [CT......+......AMP..*..cos.(..OMEGA.*.time.+.PHI..)]...*...[RAMPI.....+.....RAMP.*.time]
 vlocy      1  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
 vlocy      2  0.3000000D+01  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.2500000D+00  0.5000000D+00
 vlocy      3  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
$$$$$$
$bdyty
 RBDY2        3
$nodty
 NO3xx      1
$dofty
 vlocy      1  0.0000000D+00  0.2000000D+01  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
 vlocy      2  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
 vlocy      3 -0.7500000D-01  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
$$$$$$
)";
  texts.initial = R"(! DOF

$steps      0                time= 0.5000000D+00

$bdyty
 RBDY2        1
$nodty
 NO3xx      1                X(1)= 0.5000000D+00  X(2)=-0.2500000D+00  X(3)= 0.3000000D+01
                             V(1)= 0.7000000D+01  V(2)=-0.8000000D+01  V(3)= 0.0000000D+00
$$$$$$
)";
  return texts;
}

DatboxTexts small_datbox_in_space() {
  DatboxTexts texts;
  texts.bodies = R"($bdyty
 RBDY3      1
$blmty
 PLAIN      1  behav  STONE  avrd= 0.2000000D+00
                             I1  = 0.8377580D-03  I2  = 0.8377580D-03  I3  = 0.8377580D-03
$nodty
 NO6xx      1                coo1= 0.1000000D+01  coo2= 0.2000000D+01  coo3= 0.3000000D+01
                             coo4= 0.0000000D+00  coo5= 0.0000000D+00  coo6= 0.0000000D+00
$tacty
 SPHER      1  color  BLEUx  byrd= 0.2500000D+00
$$$$$$

$bdyty
 RBDY3      2
$blmty
 PLAIN      1  behav  HARDx  avrd= 0.0000000D+00
$nodty
 NO6xx      1                coo1= 0.5000000D+01  coo2= 0.1000000D+01  coo3= 0.0000000D+00
                             coo4= 0.0000000D+00  coo5= 0.0000000D+00  coo6= 0.0000000D+00
$tacty
 PLANx      1  color  WALLx  axe1= 0.6000000D+01  axe2= 0.7000000D+01  axe3= 0.5000000D+00
                             localframe
                             alp1= 0.0000000D+00  alp2= 0.0000000D+00  alp3= 0.1000000D+01
                             bet1= 0.0000000D+00  bet2= 0.1000000D+01  bet3= 0.0000000D+00
                             gam1=-0.1000000D+01  gam2= 0.0000000D+00  gam3= 0.0000000D+00
                             coo1= 0.0000000D+00  coo2= 0.2500000D+00  coo3= 0.0000000D+00
$$$$$$

$bdyty
 RBDY3      3
$blmty
 PLAIN      1  behav  HARDx  avrd= 0.0000000D+00
$nodty
 NO6xx      1                coo1= 0.1000000D+01  coo2= 0.2000000D+01  coo3=-0.4000000D+01
                             coo4= 0.0000000D+00  coo5= 0.0000000D+00  coo6= 0.0000000D+00
$tacty
 SPHER      1  color  ROUGE  byrd= 0.2000000D+01
$$$$$$
)";
  texts.bulk = small_datbox().bulk;
  texts.bulk = replaced(texts.bulk, "grv3= 0.0000000D+00", "grv3= 0.5000000D+00");
  texts.tact = R"($behav  lawty
 iqsc0  IQS_CLB                         fric= 0.3000000D+00

$seety
 cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert
 RBDY3  SPHER  BLEUx  iqsc0  RBDY3  PLANx  WALLx       0.5000000D-01
$seety
 cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert
 RBDY3  SPHER  ROUGE  iqsc0  RBDY3  SPHER  BLEUx       0.1000000D+00
)";
  const std::string zero = "  0.0000000D+00", one = "  0.1000000D+01";
  const auto drives = [&](int body, const std::array<const char*, 6>& velocities) {
    std::string text =
        "$bdyty\n RBDY3" + std::string(8, ' ') + std::to_string(body) + "\n$nodty\n NO6xx      1\n$dofty\n";
    for (std::size_t k = 0; k < 6; ++k)
      text += " vlocy      " + std::to_string(k + 1) + "  " + velocities[k] + zero + zero + zero + one + zero + "\n";
    return text + "$$$$$$\n";
  };
  texts.driven =
      drives(2,
             {"0.1000000D+01", "0.2000000D+01", "0.3000000D+01", "0.4000000D+01", "0.0000000D+00", "0.5000000D+01"}) +
      drives(3, {"0.0000000D+00", "0.0000000D+00", "0.7000000D+01", "0.0000000D+00", "0.0000000D+00", "0.0000000D+00"});
  texts.initial = R"($steps      0                time= 0.0000000D+00

$bdyty
 RBDY3        1
$nodty
 NO6xx      1                X(1)= 0.5000000D+00  X(2)=-0.2500000D+00  X(3)= 0.1250000D+00
                             X(4)= 0.0000000D+00  X(5)= 0.0000000D+00  X(6)= 0.0000000D+00
                             V(1)= 0.7000000D+01  V(2)=-0.8000000D+01  V(3)= 0.9000000D+01
                             V(4)= 0.0000000D+00  V(5)= 0.0000000D+00  V(6)= 0.0000000D+00
                             a(1)= 0.0000000D+00  a(2)= 0.1000000D+01  a(3)= 0.0000000D+00
                             b(1)=-0.1000000D+01  b(2)= 0.0000000D+00  b(3)= 0.0000000D+00
                             g(1)= 0.0000000D+00  g(2)= 0.0000000D+00  g(3)= 0.1000000D+01
$$$$$$
)";
  return texts;
}

}  // namespace nscdd::testing
