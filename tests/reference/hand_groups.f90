!> Tests. The Assur groups of the decks in input/, stated by hand from the drawings: crank first, then dyad upon dyad. A
!> star stands before a group that holds a drive, a minus before one that no table needs.
module hand_groups
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use structure, only: group_t
   use motion, only: diagnostic_t, new_diagnostic, diagnostic_redundant, diagnostic_change
   implicit none
   private
   public :: groups_by_hand, redundant_by_hand, passages_by_hand

   !> A change point that lies between two instants.
   type :: branch_switch_t
      character(24) :: deck = ''
      real(wp) :: t = 0.0_wp
      character(24) :: links = ''
      logical :: other = .false.         !< as a BRANCH card asks for
   end type branch_switch_t

   ! Cranks at 180 and 360 deg, from 20 deg at 10 deg a second and from 15 deg at 12.5; at 90 and 270 deg from 30 deg
   ! at 12.
   type(branch_switch_t), parameter :: branch_switches(23) = [ &
      branch_switch_t('parallelogram', 16.0_wp, 'COUPLER ROCKER'), branch_switch_t('parallelogram', 34.0_wp, &
      'COUPLER ROCKER'), &
      branch_switch_t('kite_across', 16.0_wp, 'COUPLER ROCKER'), branch_switch_t('kite_across', 34.0_wp, &
      'COUPLER ROCKER'), &
      branch_switch_t('antiparallelogram_across', 13.2_wp, 'COUPLER ROCKER'), &
      branch_switch_t('antiparallelogram_across', 27.6_wp, 'COUPLER ROCKER'), &
      branch_switch_t('scott_russell', 5.0_wp, 'BAR'), branch_switch_t('scott_russell', 20.0_wp, 'BAR'), &
      branch_switch_t('parallelogram_branch', 16.0_wp, 'COUPLER ROCKER', .true.), &
      branch_switch_t('parallelogram_branch', 34.0_wp, 'COUPLER ROCKER', .true.), &
      branch_switch_t('antiparallelogram_branch', 27.6_wp, 'COUPLER ROCKER', .true.), &
      branch_switch_t('antiparallelogram_branch', 13.2_wp, 'COUPLER ROCKER'), &
      branch_switch_t('kite_branch', 16.0_wp, 'COUPLER ROCKER', .true.), &
      branch_switch_t('kite_branch', 34.0_wp, 'COUPLER ROCKER', .true.), &
      branch_switch_t('scott_russell_branch', 5.0_wp, 'BAR', .true.), branch_switch_t('scott_russell_branch', 20.0_wp, &
      'BAR'), &
      branch_switch_t('parallelogram_at', 16.0_wp, 'COUPLER ROCKER'), branch_switch_t('parallelogram_at', 34.0_wp, &
      'COUPLER ROCKER'), &
      branch_switch_t('antiparallelogram_at', 13.2_wp, 'COUPLER ROCKER'), &
      branch_switch_t('kite_at', 16.0_wp, 'COUPLER ROCKER'), branch_switch_t('kite_at', 34.0_wp, 'COUPLER ROCKER'), &
      branch_switch_t('scott_russell_at', 5.0_wp, 'BAR'), branch_switch_t('scott_russell_at', 20.0_wp, 'BAR')]

   !> Of all sets of a deck (0) or of one.
   type :: statement_t
      character(24) :: deck = ''
      integer :: set = 0
      character(100) :: groups = ''
      character(40) :: redundant = ''    !< pairs with equations that could be spared, one a name
   end type statement_t

   type(statement_t), parameter :: statements(*) = [ &
      statement_t('yoke', 0, '*CRANK; BLOCK LEVER; ROD RAM'), &
      statement_t('jarzmowy', 0, '*CRANK; BLOCK LEVER; ROD RAM'), &
      statement_t('yoke_mirrored', 0, '*CRANK; BLOCK LEVER; ROD RAM'), &
      statement_t('four_bar', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('stroke', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('crank_rockers', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('tolerances', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('guide_tolerances', 0, '*CRANK; ROD PISTON'), &
      statement_t('poles', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('cardan', 0, '*BAR SHOE-A SHOE-B'), &
      statement_t('rise_dwell', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('drawing', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('transmission', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('geneva', 0, '*CRANK; WHEEL BLOCK'), &
      statement_t('geneva_slot', 0, '*CRANK; WHEEL'), &
      statement_t('crank_shaper', 0, '*CRANK; ARM; ROD RAM'), &
      statement_t('book_four_bar', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('points_meet', 0, '*BLOCK; *CROSS'), &
      statement_t('boom', 0, '*BOOM BARREL ROD'), &
      statement_t('landing_gear', 0, '*LEG BARREL ROD; UPPER LOWER'), &
      statement_t('leverage', 0, '*ARM'), &
      statement_t('jacobian', 0, '*UPPER; *FORE'), &
      statement_t('drawn_slider', 1, '*CRANK; ROD SLIDER'), &
      statement_t('drawn_slider', 2, '*SLIDER; CRANK ROD'), &
      statement_t('drawn_cylinder', 0, '*BOOM BARREL ROD'), &
      statement_t('crank_slider', 0, '*CRANK; ROD PISTON'), &
      statement_t('scotch_yoke', 1, '*CRANK; BLOCK YOKE'), &
      statement_t('scotch_yoke', 2, '*YOKE; CRANK BLOCK'), &
      statement_t('whitworth', 0, '*CRANK; BLOCK ARM; ROD RAM'), &
      statement_t('drag_link', 0, '*CRANK; COUPLER FOLLOWER'), &
      ! A cylinder is a drive between two links: boom, barrel and piston are found at once.
      statement_t('cylinder', 0, '*BOOM BARREL PISTON'), &
      statement_t('trammel', 1, '*BAR SHOE-A SHOE-B'), &
      statement_t('trammel', 2, '*SHOE-A; BAR SHOE-B'), &
      statement_t('peaucellier', 0, '*CRANK; ARM-A BAR-AC; ARM-B BAR-BC; BAR-AP BAR-BP'), &
      statement_t('five_bar', 0, '*LEFT; *RIGHT; ROD-L ROD-R'), &
      ! Both drives hold the pin of the first dyad.
      statement_t('pantograph', 0, '*ARM-OB ROD-AD; ARM-BT ROD-CD'), &
      statement_t('andrews', 0, '*K1; K2 K3; K4 K5; K6 K7'), &
      statement_t('jansen', 0, '*CRANK; ROD-J UPPER; ROD-K ROD-C; ROD-F FOOT'), &
      statement_t('watt', 0, '*CRANK; COUPLER ROCKER; ROD OUTPUT'), &
      statement_t('stephenson', 0, '*CRANK; COUPLER ROCKER; ROD OUTPUT'), &
      statement_t('watt_output', 0, '*OUTPUT; ROCKER ROD; CRANK COUPLER'), &
      ! Without a dyad: four links at once.
      statement_t('stephenson_output', 0, '*OUTPUT; CRANK COUPLER ROCKER ROD'), &
      statement_t('three_rrr_cranks', 0, '*CRANK-1; *CRANK-2; *CRANK-3; PLATFORM ROD-1 ROD-2 ROD-3'), &
      statement_t('klann', 0, '*CRANK; ROD LOWER; UPPER LEG'), &
      statement_t('grounds', 0, '*CRANK; COUPLER ROCKER; ROD RAM'), &
      statement_t('three_rrr', 0, '*PLATFORM; CRANK-1 ROD-1; CRANK-2 ROD-2; CRANK-3 ROD-3'), &
      statement_t('excavator', 0, &
      '*BOOM BARREL-1 PISTON-1; *STICK BARREL-2 PISTON-2; *ROCKER BARREL-3 PISTON-3; BUCKET TIE'), &
      statement_t('xy_table', 0, '*SADDLE; *TABLE; *PLATE'), &
      statement_t('scissor', 0, '*FOOT; BAR-A1 BAR-B1; BAR-A2 BAR-B2; BAR-A3 BAR-B3; PLATFORM SHOE'), &
      statement_t('chebyshev', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('kite', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('antiparallelogram', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('hart', 0, '*CRANK; BAR-AB BAR-DA; BAR-BC BAR-CD'), &
      statement_t('two_loops', 0, '*CRANK-1; *CRANK-2; COUPLER ROCKER; ROD PISTON'), &
      statement_t('crank_inline', 0, '*CRANK; ROD PISTON'), &
      statement_t('inverted_slider', 0, '*CRANK; LEVER BLOCK'), &
      statement_t('oldham', 0, '*DISC-1; DISC-2 CROSS'), &
      statement_t('near_equal_rod', 0, '*CRANK; ROD PISTON'), &
      statement_t('many_turns', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('parallelogram_branch', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('antiparallelogram_branch', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('kite_branch', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('scott_russell_branch', 0, '*CRANK; BAR SHOE'), &
      statement_t('parallelogram', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('parallelogram_at', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('antiparallelogram_across', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('antiparallelogram_at', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('kite_across', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('kite_at', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('ten_plates', 0, '*C1 C3 C4; *C2 C5 C6; C7 C8; C9 C10'), &
      statement_t('teaching_four_bar', 0, '*ABH; BCFG CDEI'), &
      statement_t('watt_i', 0, '*AB; BCD CFG; DE EF'), &
      statement_t('platform', 0, 'PLATFORM LEG-1 LEG-2 LEG-3'), &
      statement_t('triple_rocker', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('far_small', 0, '*CRANK; COUPLER ROCKER'), &
      statement_t('scott_russell', 0, '*CRANK; BAR SHOE'), &
      statement_t('scott_russell_at', 0, '*CRANK; BAR SHOE'), &
      statement_t('dead_point_6', 0, '*PISTON; CRANK ROD'), &
      statement_t('dead_point_9', 0, '*PISTON; CRANK ROD'), &
      statement_t('dead_point_12', 0, '*PISTON; CRANK ROD'), &
      ! Links that equations too many tie together are one group. Which equation is too many is a matter of choice:
      ! it is that of the last pair that closes a loop.
      statement_t('parallel_cranks', 0, '*CRANK-1 CRANK-2 CRANK-3 COUPLER', 'PAIR-C'), &
      statement_t('double_parallelogram', 0, '*CRANK-A CRANK-B LOWER UPPER', 'PAIR-B2'), &
      statement_t('two_guides', 0, '*CRANK; ROD CARRIAGE', 'GUIDE-2 GUIDE-2'), &
      statement_t('cognates', 0, '*CRANK COUPLER ROCKER CRANK-L COUP-L ROCKER-L CRANK-R COUP-R ROCKER-R', &
      'PAIR-PL PAIR-PR'), &
      statement_t('dixon', 0, '*BAR-12 BAR-13 BAR-21 BAR-22 BAR-23 BAR-31 BAR-32 BAR-33', 'PAIR-A32')]

contains

   !> The groups of set `m` of the deck called `name`; none where nothing is stated.
   function groups_by_hand(name, m) result(groups)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(group_t), allocatable :: groups(:)
      character(:), allocatable :: rest
      integer :: i, last

      allocate (groups(0))
      do i = 1, size(statements)
         if (statements(i)%deck /= name .or. all(statements(i)%set /= [0, m%set_number])) cycle
         rest = trim(statements(i)%groups)//';'
         do while (len(rest) > 0)
            last = index(rest, ';')
            groups = [groups, group(m, adjustl(rest(:last - 1)))]
            rest = rest(last + 1:)
         end do
         return
      end do
   end function groups_by_hand

   !> What is to be said of the redundant equations of the deck called `name`.
   function redundant_by_hand(name, m) result(list)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), allocatable :: list(:)
      integer :: i, k, n

      allocate (list(0))
      do i = 1, size(statements)
         if (statements(i)%deck /= name) cycle
         do k = 1, size(m%pairs)
            n = mentions(' '//statements(i)%redundant, ' '//trim(m%pairs(k)%name)//' ')
            if (n > 0) list = [list, diagnostic_t(kind=diagnostic_redundant, pair=k, equations=n)]
         end do
      end do
   end function redundant_by_hand

   !> How often `word`, a blank before and behind it, is in `text`.
   pure integer function mentions(text, word)
      character(*), intent(in) :: text, word
      integer :: k

      mentions = count([(text(k:k + len(word) - 1) == word, k=1, len(text) - len(word) + 1)])
   end function mentions

   !> The change points of the deck called `name` that are passed on the way from `before` to `t`, and those in which
   !> `t` lies.
   function passages_by_hand(name, m, before, t) result(list)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: before, t
      type(diagnostic_t), allocatable :: list(:)
      type(diagnostic_t) :: r
      integer :: i, k

      allocate (list(0))
      do i = 1, size(branch_switches)
         if (branch_switches(i)%deck /= name .or. branch_switches(i)%t < min(before, &
            t) .or. branch_switches(i)%t > max(before, t)) cycle
         r = new_diagnostic(diagnostic_change, [(index(' '//branch_switches(i)%links, ' '//trim(m%links(k)%name)//' ') &
            > 0, k=1, size(m%links))])
         r%t = branch_switches(i)%t
         r%other = branch_switches(i)%other
         r%here = abs(branch_switches(i)%t - t) <= 0.0_wp
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
end module hand_groups
