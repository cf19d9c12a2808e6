!> A planar mechanism and the requests about its motion, as plain data: links, points, pairs, drives. The folder deck/
!> builds a mechanism; all other modules read it. Lengths and times are in the deck's units, angles in rad.
module mechanism
   use kinds, only: wp, label_length, title_length
   use splines, only: spline_t
   implicit none
   private :: wp, label_length, title_length, spline_t

   integer, parameter :: pair_revolute = 1   !< REVOLUTE: eq. (7), (8)
   integer, parameter :: pair_prismatic = 2  !< PRISM: eq. (9), (10)

   !> A kind of pairs, without numbers.
   type :: pair_kind_t
      logical :: has_guide = .false.         !< Q of link j slides along a guide of link i; without relative turn
   end type pair_kind_t

   !> All that is known of each kind of pairs, without numbers.
   type(pair_kind_t), parameter :: pair_kinds(pair_revolute:pair_prismatic) = [pair_kind_t(), pair_kind_t(.true.)]

   !> The kinds of members of a mechanism that have a name and a row in the tables.
   integer, parameter :: request_link = 1, request_point = 2, request_pair = 3, request_measure = 4
   !> The kinds of requests for instant centres and for centres of curvature, cards POLE and CURVE.
   integer, parameter :: request_pole = 5, request_curve = 6
   !> The kind of the rows of ratios. A request for a ratio has the kind of the quantity, and a drive.
   integer, parameter :: request_ratio = 7

   integer, parameter :: measure_distance = 1   !< DISTANCE: the length from point 1 to point 2
   integer, parameter :: measure_line = 2    !< LINE: the direction from point 1 to point 2
   integer, parameter :: measure_angle = 3   !< ANGLE: from subject 1 to subject 2, each a LINE or a link
   integer, parameter :: measure_xi = 4      !< XI: xi of point 1 in the axes of link 2
   integer, parameter :: measure_eta = 5     !< ETA: eta of point 1 in the axes of link 2
   integer, parameter :: measure_sum = 6     !< SUM: of measures and pairs times factors, and a constant

   integer, parameter :: drive_angle = 1     !< ANGLE: phi of link `subject`
   integer, parameter :: drive_x = 2         !< X: x of point `subject`
   integer, parameter :: drive_y = 3         !< Y: y of point `subject`
   integer, parameter :: drive_relangle = 4  !< RELANGLE: phi of link `second` less phi of link `subject`
   integer, parameter :: drive_slide = 5     !< SLIDE: slide of prismatic pair `subject`
   !> The words of the kinds of drives on cards, and the kinds of the subjects of drives.
   character(label_length), parameter :: drive_words(5) = &
      [character(label_length) :: 'ANGLE', 'X', 'Y', 'RELANGLE', 'SLIDE']
   integer, parameter :: driven_kinds(5) = [request_link, request_point, request_point, request_link, request_pair]

   integer, parameter :: term_harmonic = 1   !< r(1) sin(r(2) t + r(3))
   integer, parameter :: term_power = 2      !< r(1) t**r(2)
   integer, parameter :: term_table = 3      !< the C2 spline through (knots, values)
   !> Kinds of rises: 0 before the time r(1), then r(3) s(u), u = (t - r(1))/r(2) from 0 to 1, then r(3).
   integer, parameter :: term_cycloid = 4    !< cycloidal: s = u - sin(2 pi u)/(2 pi)
   integer, parameter :: term_345 = 5        !< the 3-4-5 polynomial: s = 10 u**3 - 15 u**4 + 6 u**5
   integer, parameter :: term_cosine = 6     !< simple harmonic: s = (1 - cos(pi u))/2
   integer, parameter :: term_parabola = 7   !< constant acceleration: s = 2 u**2, from u = 1/2 on 1 - 2 (1 - u)**2

   !> A kind of terms, without numbers.
   type :: term_kind_t
      character(label_length) :: word = ''   !< on its ADD or RISE card
      character(9) :: numbers(3) = ''        !< the names of r(1) to r(3); '': it has no such number
      integer :: inexact = 3                 !< so many numbers, from r(1) on, can have a tolerance and a rounding
      logical :: has_rows = .false.          !< it has a table instead of r
      logical :: is_rise = .false.           !< it is on a RISE card
      logical :: jumps = .false.             !< its acceleration jumps at its joints
      real(wp) :: joints(3) = 0.0_wp         !< of a rise, where a derivative jumps: parts of its duration; may repeat
   end type term_kind_t

   !> The names of r(1) to r(3) of a rise.
   character(9), parameter, private :: rise_numbers(3) = ['START    ', 'DURATION ', 'LIFT     ']
   !> All that is known of each kind of terms, without numbers. A rise has joints at its ends, a rise of constant
   !> acceleration one in its middle as well.
   type(term_kind_t), parameter :: term_kinds(term_harmonic:term_parabola) = [ &
      term_kind_t('HARMONIC', [character(9) :: 'AMPLITUDE', 'FREQUENCY', 'PHASE']), &
      term_kind_t('POWER', [character(9) :: 'FACTOR', 'EXPONENT', ''], inexact=1), &
      term_kind_t('TABLE', has_rows=.true.), &
      term_kind_t('CYCLOID', rise_numbers, is_rise=.true., joints=[0.0_wp, 1.0_wp, 1.0_wp]), &
      term_kind_t('3-4-5', rise_numbers, is_rise=.true., joints=[0.0_wp, 1.0_wp, 1.0_wp]), &
      term_kind_t('HARMONIC', rise_numbers, is_rise=.true., jumps=.true., joints=[0.0_wp, 1.0_wp, 1.0_wp]), &
      term_kind_t('PARABOLA', rise_numbers, is_rise=.true., jumps=.true., joints=[0.0_wp, 1.0_wp, 0.5_wp])]

   !> The kinds of numbers on cards.
   integer, parameter :: parameter_link = 1     !< x, y or phi of link `subject`
   integer, parameter :: parameter_point = 2    !< xi or eta of point `subject`
   integer, parameter :: parameter_joint = 3    !< x or y, in the drawing, of points `subject` and `subject` + 1
   integer, parameter :: parameter_pair = 4     !< alpha, h or beta of prismatic pair `subject`
   integer, parameter :: parameter_drive = 5    !< of drive `subject`, or of its term `term`
   integer, parameter :: parameter_knot = 6     !< the time of a row of term `term` of drive `subject`, a table
   integer, parameter :: parameter_time = 7     !< T0, or T1 or the number of turns, of TIME
   integer, parameter :: parameter_length = 8   !< of the length `subject`, in the order in which lengths are applied
   integer, parameter :: parameter_hole = 9     !< x or y, in the drawing, of the hole of point `subject` of a JOINT
   integer, parameter :: parameter_stroke = 10   !< least or greatest length of cylinder `subject`, a pair

   integer, parameter :: method_newton = 1   !< Newton's method, block by block
   integer, parameter :: method_matrix = 2   !< the iteration of 1987 with frozen c(phi), s(phi)
   integer, parameter :: method_dense = 3    !< Newton's method on all closure equations at once: the reference
   !> The words of the methods on METHOD cards.
   character(label_length), parameter :: method_words(3) = [character(label_length) :: 'NEWTON', 'MATRIX', 'DENSE']

   integer, parameter :: own_predictor = -1  !< the order of the predictor that the method chooses

   !> The kinds of remarks: things in a deck that are harmless, or probably not meant.
   enum, bind(c)
      enumerator :: remark_title_long = 1       !< a title is cut
      enumerator :: remark_title_letters        !< a title has letters that are not ASCII
      enumerator :: remark_touching             !< two numbers touch
      enumerator :: remark_link_unused          !< no pair and no drive uses a link: it rests
      enumerator :: remark_point_unused         !< no pair, drive, measure, LENGTH or PRINT card uses a point
      enumerator :: remark_radians              !< an angle in radians looks like an angle in degrees
      enumerator :: remark_jumps                !< the acceleration of a rise jumps
      enumerator :: remark_open                 !< the numbers of a pair contradict the drawing
      enumerator :: remark_stroke               !< a cylinder is drawn beyond its stroke
      enumerator :: remark_alpha                !< the axes of a guide's link are turned against the axes of the drawing
      enumerator :: remark_rest                 !< no drive moves; `text` names one of them, or several
      enumerator :: remark_turns                !< a drive turns once or more between two instants
      enumerator :: remark_more                 !< there are more remarks; `text` has their number
   end enum

   !> A remark about `text`, which begins at `column` of a card; its sentence ends with `value`.
   type :: remark_t
      integer :: kind = 0                      !< remark_title_long, ...
      integer :: card = 0, column = 0          !< number of the card in the deck, and column
      character(112) :: text = ''              !< of the card, or names of drives
      character(40) :: value = ''              !< numbers with their units; '' if the sentence has none
   end type remark_t

   !> A rigid link, with axes of its own.
   type :: link_t
      character(label_length) :: name = ''
      logical :: ground = .false.            !< does not move
      real(wp) :: position(3) = 0.0_wp       !< x, y, phi: fixed (ground) or the estimate that selects the assembly
      logical :: hidden = .false.            !< the block of a SLOT card: it has no name, and no table shows it
      integer :: from = 0, to = 0            !< the points at which its axes begin and to which they point; 0: none
      logical :: along(3) = .false.          !< x, y, phi: these points give the number, not the card
   end type link_t

   !> A point of a link.
   type :: point_t
      character(label_length) :: name = ''
      integer :: link = 0                    !< the number of its link
      real(wp) :: offset(2) = 0.0_wp         !< xi, eta in the axes of the link
      logical :: drawn = .false.             !< one of two points of a JOINT card, drawn at one position
      !> Where it is before lengths move it: of a JOINT x, y in the drawing, of another point of a hole xi, eta.
      real(wp) :: place(2) = 0.0_wp
      integer :: hole = 0                    !< a number that all points of one hole share; 0: not sought
      logical :: moves = .false.             !< lengths have moved it
   end type point_t

   !> A LENGTH card: the distance of two points of one body.
   type :: length_t
      integer :: point(2) = 0                !< the numbers of the points P and Q of its link or of the ground
      integer :: hole(2) = 0                 !< the holes of P and Q
      real(wp) :: length = 0.0_wp            !< the distance of P and Q
      character(label_length) :: link = ''   !< the link that its card names
   end type length_t

   !> A pair of two links.
   type :: pair_t
      integer :: kind = pair_revolute        !< pair_revolute or pair_prismatic
      character(label_length) :: name = ''
      integer :: point_i = 0, point_j = 0    !< the numbers of the points P of link i and Q of link j
      real(wp) :: alpha = 0.0_wp             !< prismatic: direction of the guide in link i
      real(wp) :: offset = 0.0_wp            !< prismatic: h of eq. (9)
      real(wp) :: beta = 0.0_wp              !< prismatic: phi_j - phi_i, eq. (10)
      logical :: drawn(3) = .false.          !< alpha, h, beta: the drawing gives the number, not the card
      !> Prismatic, of a SLOT card: the number of the point of link j that moves in the slot. Q is a point of the block.
      integer :: pin = 0
      logical :: is_cylinder = .false.       !< its slide is a length above 0
      real(wp) :: stroke(2) = [0.0_wp, huge(1.0_wp)]   !< of a cylinder: its least and greatest length
   end type pair_t

   !> A subject of a measure: a link, point, pair or measure.
   type :: subject_t
      integer :: kind = 0                    !< request_link, request_point, request_pair or request_measure
      integer :: number = 0                  !< of the link, point, pair or measure
      real(wp) :: factor = 1.0_wp            !< by which a sum multiplies its value
   end type subject_t

   !> A scalar that its card measures in the motion.
   type :: measure_t
      integer :: kind = measure_distance     !< measure_distance, ..., measure_sum
      character(label_length) :: name = ''
      type(subject_t), allocatable :: subjects(:)   !< (2) or, of a sum, any number, none of them a sum
      real(wp) :: constant = 0.0_wp          !< of a sum, length or rad
      logical :: is_angle = .false.          !< an angle, otherwise a length
      logical :: continues = .false.         !< without jumps of whole turns: the value nearest to the last instant's
      real(wp) :: length = 1.0_wp            !< characteristic length of its independent mechanism
   end type measure_t

   !> One term of the law of a drive.
   type :: term_t
      integer :: kind = term_harmonic        !< term_harmonic, ..., term_parabola
      real(wp) :: r(3) = 0.0_wp              !< R1, R2, R3 of the card; angles in radians
      type(spline_t) :: table                !< of a table: its times, increasing, and values; with its spline
   end type term_t

   !> A drive: the coordinate that it drives, and its law.
   type :: drive_t
      integer :: kind = drive_angle          !< drive_angle, ..., drive_slide
      integer :: subject = 0                 !< the number of a link, point or pair: driven_kinds(kind)
      integer :: second = 0                  !< drive_relangle: the number of the second link
      real(wp) :: polynomial(3) = 0.0_wp     !< value at t = 0 (length or rad), rate, acceleration
      type(term_t), allocatable :: terms(:)  !< of its ADD and RISE cards; none: not allocated
      logical :: drawn = .false.             !< the drawing gives its value at t = 0, not its card
      logical :: turns = .false.             !< its card gives the rate in revolutions per minute
   end type drive_t

   !> A request about a link, point, pair or measure: a row of the tables, its extremes, or both. The motion of a link
   !> (request_pole) or the path of a point (request_curve) is seen from the link `second`.
   type :: request_t
      integer :: kind = request_link         !< request_link, ..., request_curve
      integer :: subject = 0                 !< the number of the link, point, pair or measure
      integer :: every = 1                   !< a row at every such instant, the first and the last; 0: no row
      logical :: extremes = .false.          !< its extremes over the run are requested
      real(wp) :: dwell(2) = 0.0_wp          !< (length, rad) dwells within this distance are requested; 0: none
      integer :: second = 0                  !< the link from which a motion is seen; of a curve 0: the fixed plane
      real(wp) :: length = 1.0_wp, rate = 1.0_wp   !< of a pole or curve: characteristic, of its mechanism
      logical :: listed = .false.            !< a row in the listing at every instant, which no card requests
      logical :: angle_alone = .false.       !< of a link: the rows of the listing have only its angle
      integer :: drive = 0                   !< of a ratio: the number of the drive that has the rate 1; 0: no ratio
      logical :: in_columns = .false.        !< a COLUMN card names it: a row in the CSV at every instant
      logical :: sought(3, 0:2) = .true.     !< (coordinate, derivative) the numbers whose extremes are sought
   end type request_t

   !> The request of a COLUMN card: one number of a row at every instant.
   type :: column_request_t
      integer :: request = 0                 !< the number of the row among the requests of the set
      integer :: at(2) = 0                   !< which number: coordinate (1 to 3); derivative or axes (0 to 2)
   end type column_request_t

   !> At the next change point after `t`, `link` takes the other branch; link 0: any links that pass a change point.
   type :: branch_request_t
      integer :: link = 0                    !< its number; 0: any
      real(wp) :: t = 0.0_wp                 !< time
      integer :: card = 0                    !< of a part: its number among the BRANCH cards of the set
   end type branch_request_t

   !> A number on a card: its address, which `parameters` explains.
   type :: parameter_t
      integer :: kind = parameter_point         !< parameter_link, ..., parameter_stroke; 0: no number of a mechanism
      integer :: subject = 0                 !< the number of its link, point, pair, drive or length; of TIME 0
      integer :: term = 0                    !< of a drive: the number of the term; 0: its polynomial
      integer :: place = 1                   !< 1 to 3: R1 to R3 of the card; of a table the row
   end type parameter_t

   !> The tolerance of a number on a card.
   type, extends(parameter_t) :: tolerance_t
      real(wp) :: size_of = 0.0_wp           !< the tolerance, above 0, in the unit of the number on its card
      real(wp) :: unit = 1.0_wp              !< that unit in the units of `mechanism_t`
      real(wp) :: powers(2) = [1.0_wp, 0.0_wp]   !< exponents of length and of time in that unit
      character(48) :: name = ''             !< of the number, in tables
      character(24) :: text = ''             !< the tolerance as it stands on its card
      character(2*label_length + 5) :: unit_name = ''   !< that unit as text, in tables
   end type tolerance_t

   !> Options and instants of a set: its independent mechanisms have them all.
   type :: settings_t
      integer :: set_number = 1              !< of the set in its deck
      character(label_length) :: length_unit = 'M', time_unit = 'S'   !< printed, never converted
      logical :: degrees = .false.           !< angles are printed in degrees
      logical :: polish = .false.            !< headings are printed in Polish
      integer :: method = method_newton      !< method_newton, method_matrix or method_dense
      real(wp) :: tolerance = 0.0_wp         !< relative, of corrections; 0: the method's own
      real(wp) :: closing = 0.0_wp           !< of redundant equations: tolerance (characteristic lengths, rad); 0: none
      logical :: ranges = .false.            !< the ranges of the drives are requested
      logical :: proves = .false.            !< a proof of each step is requested
      logical :: assemblies = .false.        !< all assemblies at the first instant are requested
      logical :: circuits = .false.          !< the circuits of the mechanism are requested
      integer :: predictor = own_predictor   !< order of the predictor of a step, 0 to 3; no card sets it
      integer :: variants = 0                !< number of variants of its VARY cards; 0: no VARY card
      integer :: variant = 0                 !< number of this variant; 0: the numbers stand in the deck
      integer :: steps = -1                  !< of the TIME card: steps + 1 instants from t0 to t1; -1: no TIME card
      real(wp) :: t0 = 0.0_wp, t1 = 0.0_wp   !< of the TIME card
      real(wp) :: turns = 0.0_wp             !< of the TIME card: turns of the drive from t0 to t1; 0: t1 is given
      real(wp), allocatable :: at(:)         !< the instants of the AT cards, which come after the TIME card's
      type(column_request_t), allocatable :: columns(:)   !< of the COLUMN cards; none: not allocated
   end type settings_t

   !> A set of computations, or one of its independent mechanisms (a part), which has the settings of its set.
   type, extends(settings_t) :: mechanism_t
      character(title_length) :: title = ''  !< of the card TITLE
      type(link_t), allocatable :: links(:)
      type(point_t), allocatable :: points(:)
      type(pair_t), allocatable :: pairs(:)
      type(measure_t), allocatable :: measures(:)   !< none: not allocated, or of size 0
      type(drive_t), allocatable :: drives(:)
      type(request_t), allocatable :: requests(:)
      type(branch_request_t), allocatable :: branch_requests(:)   !< none: not allocated, or of size 0
      type(length_t), allocatable :: lengths(:)   !< in the order in which they are applied; none: not allocated
      type(tolerance_t), allocatable :: tolerances(:)   !< none: not allocated
      character(120), allocatable :: echo(:) !< the cards as they were understood, for the listing
      type(remark_t), allocatable :: remarks(:)   !< about the cards; none: not allocated
   end type mechanism_t

contains

   !> Counts the instants of a set: the instants of TIME and of AT.
   pure integer function instant_count(settings)
      class(settings_t), intent(in) :: settings   !< of a set or of a part of it

      instant_count = settings%steps + 1 + size(settings%at)
   end function instant_count

   !> Gives the time of an instant, in the deck's unit. The last instant of TIME is exactly t1.
   pure real(wp) function instant(settings, k) result(t)
      class(settings_t), intent(in) :: settings   !< of a set or of a part of it
      integer, intent(in) :: k               !< number of the instant, from 0 to instant_count - 1

      if (k > settings%steps) then
         t = settings%at(k - settings%steps)
      else if (k == settings%steps) then
         t = settings%t1
      else
         t = settings%t0 + (settings%t1 - settings%t0)*real(k, wp)/real(settings%steps, wp)
      end if
   end function instant

   !> Finds the times of the earliest and the latest instant of a set. Without instants the times are huge and -huge.
   pure subroutine find_instants(settings, first, last)
      class(settings_t), intent(in) :: settings   !< of a set or of a part of it
      real(wp), intent(out) :: first, last   !< earliest and latest time, in the deck's unit

      first = huge(first)
      last = -huge(last)
      if (allocated(settings%at)) then
         first = minval(settings%at)
         last = maxval(settings%at)
      end if
      if (settings%steps < 0) return
      first = min(first, settings%t0, settings%t1)
      last = max(last, settings%t0, settings%t1)
   end subroutine find_instants

   !> Finds the origin x, y (2, deck's unit of length) from which all computed positions are counted: the origin of the
   !> first ground link that a pair uses, otherwise of the first ground link, without any 0, 0. The origin is added when
   !> a row is written. Reason: far from the origin of the deck, or from a ground link that only a row uses, small
   !> lengths would have the rounding of large positions.
   pure function plane_origin(m) result(origin)
      type(mechanism_t), intent(in) :: m
      real(wp) :: origin(2)
      logical :: in_pair(size(m%links))
      integer :: first

      origin = 0.0_wp
      in_pair = .false.
      in_pair(m%points(m%pairs%point_i)%link) = .true.
      in_pair(m%points(m%pairs%point_j)%link) = .true.
      first = findloc(m%links%ground .and. in_pair, .true., dim=1)
      if (first == 0) first = findloc(m%links%ground, .true., dim=1)
      if (first > 0) origin = m%links(first)%position(:2)
   end function plane_origin

   !> Finds the numbers of links i and j (2) of a pair.
   pure function pair_links(m, pair) result(links)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`
      integer :: links(2)

      links = m%points([pair%point_i, pair%point_j])%link
   end function pair_links

   !> Finds the numbers of the links (3) on which the coordinate of a drive depends. Of fewer than three links some
   !> appear several times.
   pure function drive_links(m, drive) result(links)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: drive     !< of `m`
      integer :: links(3)

      links = subject_links(m, driven_kinds(drive%kind), drive%subject, drive%second)
   end function drive_links

   !> Finds the links on whose motion the row of a request depends, some of them several times.
   pure function request_links(m, request) result(links)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request !< of `m`
      integer, allocatable :: links(:)       !< (1 or more) their numbers

      if (request%kind == request_measure) then
         links = measure_links(m, m%measures(request%subject))
      else
         links = subject_links(m, request%kind, request%subject, request%second)
      end if
   end function request_links

   !> Tells whether all links on which the row of a request depends are ground links.
   pure logical function is_fixed(m, request)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request !< of `m`

      is_fixed = all(m%links(request_links(m, request))%ground)
   end function is_fixed

   !> Tells whether the value of a request is a sum of numbers of cards: its links are ground, and its subject is no
   !> measure.
   pure logical function is_sum_of_numbers(m, request)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request !< of `m`

      is_sum_of_numbers = request%kind /= request_measure .and. is_fixed(m, request)
   end function is_sum_of_numbers

   !> Gives the length of the larger of the two vectors whose sum is the position of a ground point: the link's origin
   !> and the point's offset. Any other request gives 0: on the ground it has numbers of cards as they stand.
   pure real(wp) function largest_summand(m, request)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request !< of `m`

      largest_summand = 0.0_wp
      if (request%kind == request_point) largest_summand = max(norm2(m%points(request%subject)%offset), &
         norm2(m%links(m%points(request%subject)%link)%position(:2)))
   end function largest_summand

   !> Finds the numbers of the links (3) of a subject that is no measure. Of fewer than three links some appear several
   !> times.
   pure function subject_links(m, kind, subject, second) result(links)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: kind            !< request_link, ...
      integer, intent(in) :: subject         !< the number of the link, point or pair
      integer, intent(in) :: second          !< link from which a motion is seen, or 2nd of RELANGLE; 0: none
      integer :: links(3)

      select case (kind)
      case (request_link, request_pole)
         links = subject
      case (request_point, request_curve)
         links = m%points(subject)%link
      case default
         links(:2) = pair_links(m, m%pairs(subject))
         links(3) = links(2)
      end select
      if (second > 0) links(3) = second
   end function subject_links

   !> Finds the links of the subjects of a measure, some of them several times. Subjects that are not found have none.
   pure recursive function measure_links(m, measure) result(links)
      type(mechanism_t), intent(in) :: m
      type(measure_t), intent(in) :: measure !< of `m`
      integer, allocatable :: links(:)       !< (any number) their numbers; 1 or more if the deck is right
      integer :: k

      allocate (links(0))
      do k = 1, size(measure%subjects)
         associate (one => measure%subjects(k))
            if (one%number == 0) cycle
            if (one%kind == request_measure) then
               links = [links, measure_links(m, m%measures(one%number))]
            else
               links = [links, subject_links(m, one%kind, one%number, 0)]
            end if
         end associate
      end do
   end function measure_links

   !> Counts the measures of a mechanism: 0 or more.
   pure integer function measure_count(m)
      class(mechanism_t), intent(in) :: m

      measure_count = 0
      if (allocated(m%measures)) measure_count = size(m%measures)
   end function measure_count

   !> Lists a measure and all measures among its subjects, recursively.
   pure recursive function measures_within(m, i) result(list)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i               !< number of the measure
      integer, allocatable :: list(:)        !< (1 or more) their numbers, `i` first, some several times
      integer :: k

      list = [i]
      do k = 1, size(m%measures(i)%subjects)
         associate (one => m%measures(i)%subjects(k))
            if (one%kind == request_measure) list = [list, measures_within(m, one%number)]
         end associate
      end do
   end function measures_within

   !> Finds the numbers of the two links (2) that the card of a pair joins. A SLOT card joins the link of its guide and
   !> the link of its pin, not its block.
   pure function joined_by(m, pair) result(links)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`
      integer :: links(2)

      links = pair_links(m, pair)
      if (pair%pin > 0) links(2) = m%points(pair%pin)%link
   end function joined_by

   !> Tells whether a pair is the revolute pair between the block of a slot and the pin. No table shows such a pair.
   pure logical function is_hidden(m, pair)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`

      is_hidden = pair%pin == 0 .and. m%links(m%points(pair%point_i)%link)%hidden
   end function is_hidden

   !> Removes the blocks of SLOT cards from a list of links. If no link remains, the result has the moving links that
   !> these SLOT cards join, each once.
   pure function shown_links(m, links) result(shown)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: links(:)        !< (any number) their numbers
      integer, allocatable :: shown(:)       !< (any number) the numbers of the links that may be named
      integer :: i, ends(2)

      shown = pack(links, .not. m%links(links)%hidden)
      if (size(shown) > 0 .or. size(links) == 0) return
      do i = 1, size(m%pairs)
         if (m%pairs(i)%pin == 0) cycle
         if (all(links /= m%points(m%pairs(i)%point_j)%link)) cycle
         ends = joined_by(m, m%pairs(i))
         shown = [shown, pack(ends, .not. m%links(ends)%ground .and. [all(shown /= ends(1)), all(shown /= ends(2))])]
      end do
   end function shown_links

   !> Tells whether in pairs of a kind a link slides along a guide; otherwise the link turns about a joint.
   elemental logical function has_guide(kind)
      integer, intent(in) :: kind            !< pair_revolute, ...

      has_guide = pair_kinds(kind)%has_guide
   end function has_guide

   !> Tells whether pictures show the path of a request: of a point that a card requests. Points that only the listing
   !> has by default have no path.
   elemental logical function has_path(request)
      type(request_t), intent(in) :: request !< of any mechanism

      has_path = request%kind == request_point .and. (request%extremes .or. .not. request%listed)
   end function has_path

   !> Tells of each link (links) whether a request or a cylinder needs its motion. Ranges, circuits, proofs, assemblies
   !> and tolerances need all links.
   pure function wanted_links(m) result(wanted)
      type(mechanism_t), intent(in) :: m
      logical :: wanted(size(m%links))
      integer :: i

      wanted = m%ranges .or. m%circuits .or. m%proves .or. m%assemblies .or. allocated(m%tolerances)
      do i = 1, size(m%requests)
         wanted(request_links(m, m%requests(i))) = .true.
      end do
      ! The length of a cylinder can end a motion.
      do i = 1, size(m%pairs)
         if (m%pairs(i)%is_cylinder) wanted(pair_links(m, m%pairs(i))) = .true.
      end do
   end function wanted_links

   !> Tells of each point (points) whether a pair or a drive uses it.
   pure function used_points(m) result(used)
      type(mechanism_t), intent(in) :: m
      logical :: used(size(m%points))
      integer :: i

      used = .false.
      used(m%pairs%point_i) = .true.
      used(m%pairs%point_j) = .true.
      do i = 1, size(m%drives)
         if (driven_kinds(m%drives(i)%kind) == request_point) used(m%drives(i)%subject) = .true.
      end do
   end function used_points

   !> Copies a mechanism and adds requests for all its links, after its own requests.
   pure function with_all_links(m) result(all_links)
      type(mechanism_t), intent(in) :: m
      type(mechanism_t) :: all_links
      integer :: i

      all_links = m
      all_links%requests = [m%requests, (request_t(request_link, i), i=1, size(m%links))]
   end function with_all_links
end module mechanism
