!> Tests. The structure of the decks in input/, counted and stated by hand from the drawings: numbers of links and
!> pairs, Assur groups, redundant equations, change points. Groups: crank first, then dyad upon dyad; a star stands
!> before a group that holds a drive.
module expected_groups
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use structure, only: structure_report_t, group_t
   use motion, only: diagnostic_t, new_diagnostic, diagnostic_redundant, diagnostic_change
   implicit none
   private
   public :: count_by_hand, groups_by_hand, redundant_by_hand, passages_by_hand, change_times

   !> What is stated of the decks of one structure. All links move and are named but for blocks of slots.
   type :: statement_t
      character(200) :: decks = ''
      integer :: set = 0                 !< of which all this holds; 0: of all sets
      integer :: links = 0, revolute = 0, prismatic = 0, drives = 0   !< links with the ground
      character(100) :: groups = ''
      character(40) :: redundant = ''    !< pairs with equations that could be spared, one a name
      integer :: ground = 1
      integer :: blocks = 0              !< of slots: no link and no revolute pair of the tables
   end type statement_t

   type(statement_t), parameter :: statements(*) = [ &
      statement_t('four_bar stroke crank_rockers tolerances poles rise_dwell drawing transmission book_four_bar ' &
         //'chebyshev many_turns triple_rocker far_small', 0, 4, 4, 0, 1, '*CRANK; COUPLER ROCKER'), &
      statement_t('kite kite_across kite_at kite_branch antiparallelogram antiparallelogram_across ' &
         //'antiparallelogram_at antiparallelogram_branch parallelogram parallelogram_at parallelogram_branch', &
         0, 4, 4, 0, 1, '*CRANK; COUPLER ROCKER'), &
      statement_t('drag_link', 0, 4, 4, 0, 1, '*CRANK; COUPLER FOLLOWER'), &
      statement_t('teaching_four_bar', 0, 4, 4, 0, 1, '*ABH; BCFG CDEI'), &
      statement_t('crank_slider crank_inline near_equal_rod guide_tolerances', 0, 4, 3, 1, 1, '*CRANK; ROD PISTON'), &
      statement_t('drawn_slider', 1, 4, 3, 1, 1, '*CRANK; ROD SLIDER'), &
      statement_t('drawn_slider', 2, 4, 3, 1, 1, '*SLIDER; CRANK ROD'), &
      statement_t('dead_point_6 dead_point_9 dead_point_12', 0, 4, 3, 1, 1, '*PISTON; CRANK ROD'), &
      statement_t('scott_russell scott_russell_at scott_russell_branch', 0, 4, 3, 1, 1, '*CRANK; BAR SHOE'), &
      statement_t('inverted_slider', 0, 4, 3, 1, 1, '*CRANK; LEVER BLOCK'), &
      statement_t('geneva', 0, 4, 3, 1, 1, '*CRANK; WHEEL BLOCK'), &
      statement_t('geneva_slot', 0, 3, 2, 1, 1, '*CRANK; WHEEL', blocks=1), &
      statement_t('boom drawn_cylinder', 0, 4, 3, 1, 1, '*BOOM BARREL ROD'), &
      ! A cylinder is a drive between two links: boom, barrel and piston are found at once.
      statement_t('cylinder', 0, 4, 3, 1, 1, '*BOOM BARREL PISTON'), &
      statement_t('landing_gear', 0, 6, 6, 1, 1, '*LEG BARREL ROD; UPPER LOWER'), &
      statement_t('scotch_yoke', 1, 4, 2, 2, 1, '*CRANK; BLOCK YOKE'), &
      statement_t('scotch_yoke', 2, 4, 2, 2, 1, '*YOKE; CRANK BLOCK'), &
      statement_t('trammel', 2, 4, 2, 2, 1, '*SHOE-A; BAR SHOE-B'), &
      statement_t('trammel cardan', 1, 4, 2, 2, 1, '*BAR SHOE-A SHOE-B'), &
      statement_t('oldham', 0, 4, 2, 2, 1, '*DISC-1; DISC-2 CROSS'), &
      statement_t('points_meet', 0, 3, 0, 2, 2, '*BLOCK; *CROSS'), &
      statement_t('yoke jarzmowy yoke_mirrored', 0, 6, 5, 2, 1, '*CRANK; BLOCK LEVER; ROD RAM'), &
      statement_t('whitworth', 0, 6, 5, 2, 1, '*CRANK; BLOCK ARM; ROD RAM'), &
      statement_t('crank_shaper', 0, 5, 4, 2, 1, '*CRANK; ARM; ROD RAM', blocks=1), &
      statement_t('leverage', 0, 2, 1, 0, 1, '*ARM'), &
      statement_t('jacobian', 0, 3, 2, 0, 2, '*UPPER; *FORE'), &
      statement_t('five_bar', 0, 5, 5, 0, 2, '*LEFT; *RIGHT; ROD-L ROD-R'), &
      ! Both drives hold the pin of the first dyad.
      statement_t('pantograph', 0, 5, 5, 0, 2, '*ARM-OB ROD-AD; ARM-BT ROD-CD'), &
      statement_t('two_loops', 0, 7, 7, 1, 2, '*CRANK-1; *CRANK-2; COUPLER ROCKER; ROD PISTON'), &
      statement_t('watt stephenson', 0, 6, 7, 0, 1, '*CRANK; COUPLER ROCKER; ROD OUTPUT'), &
      statement_t('watt_output', 0, 6, 7, 0, 1, '*OUTPUT; ROCKER ROD; CRANK COUPLER'), &
      ! Without a dyad: four links at once.
      statement_t('stephenson_output', 0, 6, 7, 0, 1, '*OUTPUT; CRANK COUPLER ROCKER ROD'), &
      statement_t('watt_i', 0, 6, 7, 0, 1, '*AB; BCD CFG; DE EF'), &
      statement_t('klann', 0, 6, 7, 0, 1, '*CRANK; ROD LOWER; UPPER LEG'), &
      statement_t('hart', 0, 6, 7, 0, 1, '*CRANK; BAR-AB BAR-DA; BAR-BC BAR-CD'), &
      statement_t('grounds', 0, 8, 6, 1, 1, '*CRANK; COUPLER ROCKER; ROD RAM', ground=3), &
      statement_t('peaucellier', 0, 8, 10, 0, 1, '*CRANK; ARM-A BAR-AC; ARM-B BAR-BC; BAR-AP BAR-BP'), &
      statement_t('andrews', 0, 8, 10, 0, 1, '*K1; K2 K3; K4 K5; K6 K7'), &
      statement_t('jansen', 0, 8, 10, 0, 1, '*CRANK; ROD-J UPPER; ROD-K ROD-C; ROD-F FOOT'), &
      statement_t('ten_plates', 0, 11, 12, 2, 2, '*C1 C3 C4; *C2 C5 C6; C7 C8; C9 C10'), &
      statement_t('scissor', 0, 10, 11, 2, 1, '*FOOT; BAR-A1 BAR-B1; BAR-A2 BAR-B2; BAR-A3 BAR-B3; PLATFORM SHOE'), &
      statement_t('xy_table', 0, 4, 1, 2, 3, '*SADDLE; *TABLE; *PLATE'), &
      statement_t('three_rrr', 0, 8, 9, 0, 3, '*PLATFORM; CRANK-1 ROD-1; CRANK-2 ROD-2; CRANK-3 ROD-3'), &
      statement_t('three_rrr_cranks', 0, 8, 9, 0, 3, '*CRANK-1; *CRANK-2; *CRANK-3; PLATFORM ROD-1 ROD-2 ROD-3'), &
      statement_t('excavator', 0, 12, 12, 3, 3, &
         '*BOOM BARREL-1 PISTON-1; *STICK BARREL-2 PISTON-2; *ROCKER BARREL-3 PISTON-3; BUCKET TIE'), &
      statement_t('platform', 0, 5, 6, 0, 0, 'PLATFORM LEG-1 LEG-2 LEG-3'), &
      ! Links that equations too many tie together are one group. Which equation is too many is a matter of choice:
      ! it is that of the last pair that closes a loop.
      statement_t('parallel_cranks', 0, 5, 6, 0, 1, '*CRANK-1 CRANK-2 CRANK-3 COUPLER', 'PAIR-C'), &
      statement_t('double_parallelogram', 0, 5, 6, 0, 1, '*CRANK-A CRANK-B LOWER UPPER', 'PAIR-B2'), &
      statement_t('two_guides', 0, 4, 3, 2, 1, '*CRANK; ROD CARRIAGE', 'GUIDE-2 GUIDE-2'), &
      statement_t('cognates', 0, 10, 14, 0, 1, &
      '*CRANK COUPLER ROCKER CRANK-L COUP-L ROCKER-L CRANK-R COUP-R ROCKER-R', &
         'PAIR-PL PAIR-PR'), &
      statement_t('dixon', 0, 9, 12, 0, 1, '*BAR-12 BAR-13 BAR-21 BAR-22 BAR-23 BAR-31 BAR-32 BAR-33', 'PAIR-A32')]

   !> The change points of a deck: two times, and whether the motion takes the other branch there, as a BRANCH card asks
   !> for.
   type :: change_points_t
      character(24) :: deck = ''
      real(wp) :: t(2) = 0.0_wp
      character(24) :: links = ''
      logical :: other(2) = .false.
   end type change_points_t

   ! Cranks at 180 and 360 deg, from 20 deg at 10 deg a second and from 15 deg at 12.5; at 90 and 270 deg from 30 deg
   ! at 12.
   type(change_points_t), parameter :: change_points(*) = [ &
      change_points_t('parallelogram', [16.0_wp, 34.0_wp], 'COUPLER ROCKER'), &
      change_points_t('parallelogram_at', [16.0_wp, 34.0_wp], 'COUPLER ROCKER'), &
      change_points_t('parallelogram_branch', [16.0_wp, 34.0_wp], 'COUPLER ROCKER', [.true., .true.]), &
      change_points_t('kite_across', [16.0_wp, 34.0_wp], 'COUPLER ROCKER'), &
      change_points_t('kite_at', [16.0_wp, 34.0_wp], 'COUPLER ROCKER'), &
      change_points_t('kite_branch', [16.0_wp, 34.0_wp], 'COUPLER ROCKER', [.true., .true.]), &
      change_points_t('antiparallelogram_across', [13.2_wp, 27.6_wp], 'COUPLER ROCKER'), &
      change_points_t('antiparallelogram_at', [13.2_wp, 27.6_wp], 'COUPLER ROCKER'), &
      change_points_t('antiparallelogram_branch', [13.2_wp, 27.6_wp], 'COUPLER ROCKER', [.false., .true.]), &
      change_points_t('scott_russell', [5.0_wp, 20.0_wp], 'BAR'), &
      change_points_t('scott_russell_at', [5.0_wp, 20.0_wp], 'BAR'), &
      change_points_t('scott_russell_branch', [5.0_wp, 20.0_wp], 'BAR', [.true., .false.])]

contains

   !> The number of the statement about set number `set` of the deck called `name`, of any set (0) the first; 0: nothing
   !> is stated.
   pure integer function statement_of(name, set) result(i)
      character(*), intent(in) :: name
      integer, intent(in) :: set

      do i = 1, size(statements)
         if (mentions(' '//statements(i)%decks, ' '//name//' ') == 0) cycle
         if (set == 0 .or. any(statements(i)%set == [0, set])) return
      end do
      i = 0
   end function statement_of

   !> What the listing must say of the structure of the mechanism `name`: every link with three coordinates, two
   !> equations for every pair and three for every ground link.
   pure function count_by_hand(name) result(f)
      character(*), intent(in) :: name
      type(structure_report_t) :: f
      type(statement_t) :: s
      integer :: i

      i = statement_of(name, 0)
      if (i == 0) return
      s = statements(i)
      f%links = s%links
      f%ground = s%ground
      f%revolute = s%revolute
      f%prismatic = s%prismatic
      f%drives = s%drives
      f%coordinates = 3*(f%links + s%blocks)
      f%equations = 2*(f%revolute + f%prismatic + s%blocks) + 3*f%ground
      ! In every one of these mechanisms the freedoms are driven one by one; (13) counts each equation.
      f%degrees_of_freedom = f%drives - words_in(s%redundant)
   end function count_by_hand

   !> The number of words in `text`, one blank between them.
   pure integer function words_in(text)
      character(*), intent(in) :: text

      words_in = merge(0, 1 + mentions(trim(text), ' '), text == '')
   end function words_in

   !> The groups of set `m` of the deck called `name`; none where nothing is stated.
   function groups_by_hand(name, m) result(groups)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(group_t), allocatable :: groups(:)
      character(:), allocatable :: rest
      integer :: i, last

      allocate (groups(0))
      i = statement_of(name, m%set_number)
      if (i == 0) return
      rest = trim(statements(i)%groups)//';'
      do while (len(rest) > 0)
         last = index(rest, ';')
         groups = [groups, group(m, adjustl(rest(:last - 1)))]
         rest = rest(last + 1:)
      end do
   end function groups_by_hand

   !> What is to be said of the redundant equations of the deck called `name`.
   function redundant_by_hand(name, m) result(list)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), allocatable :: list(:)
      integer :: i, k, n

      allocate (list(0))
      i = statement_of(name, m%set_number)
      if (i == 0) return
      do k = 1, size(m%pairs)
         n = mentions(' '//statements(i)%redundant, ' '//trim(m%pairs(k)%name)//' ')
         if (n > 0) list = [list, diagnostic_t(kind=diagnostic_redundant, pair=k, equations=n)]
      end do
   end function redundant_by_hand

   !> How often `word`, a blank before and behind it, is in `text`.
   pure integer function mentions(text, word)
      character(*), intent(in) :: text, word
      integer :: k

      mentions = count([(text(k:k + len(word) - 1) == word, k=1, len(text) - len(word) + 1)])
   end function mentions

   !> The times of the change points of the deck called `name`; none for a deck without.
   pure function change_times(name) result(t)
      character(*), intent(in) :: name
      real(wp), allocatable :: t(:)
      integer :: i

      allocate (t(0))
      i = findloc(change_points%deck == name, .true., dim=1)
      if (i > 0) t = change_points(i)%t
   end function change_times

   !> The change points of the deck called `name` that are passed on the way from `before` to `t`, and those in which
   !> `t` lies.
   function passages_by_hand(name, m, before, t) result(list)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: before, t
      type(diagnostic_t), allocatable :: list(:)
      type(diagnostic_t) :: r
      type(change_points_t) :: stated
      integer :: i, n, k

      allocate (list(0))
      i = findloc(change_points%deck == name, .true., dim=1)
      if (i == 0) return
      stated = change_points(i)
      do n = 1, size(stated%t)
         if (stated%t(n) < min(before, t) .or. stated%t(n) > max(before, t)) cycle
         r = new_diagnostic(diagnostic_change, &
            [(mentions(' '//stated%links, ' '//trim(m%links(k)%name)//' ') > 0, k=1, size(m%links))])
         r%t = stated%t(n)
         r%other = stated%other(n)
         r%here = abs(stated%t(n) - t) <= 0.0_wp
         list = [list, r]
      end do
   end function passages_by_hand

   !> One group from its text.
   function group(m, text) result(g)
      type(mechanism_t), intent(in) :: m
      character(*), intent(in) :: text
      type(group_t) :: g
      integer :: i, k, from
      logical :: is_in(size(m%links))

      g%driven = text(1:1) == '*'
      is_in = .false.
      from = merge(2, 1, g%driven)
      do k = 1, size(m%links)
         ! The block of a slot has no name.
         is_in(k) = m%links(k)%name /= '' .and. index(' '//text(from:)//' ', ' '//trim(m%links(k)%name)//' ') > 0
      end do
      g%links = pack([(i, i=1, size(m%links))], is_in)
   end function group
end module expected_groups
